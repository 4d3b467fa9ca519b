"""Profiles of cams and curved slots as tables of points for machining."""
