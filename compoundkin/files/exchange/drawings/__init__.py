"""Drawings, between formats and mechanisms: one pose of links, points, guides, gears and drivers, by keys."""
