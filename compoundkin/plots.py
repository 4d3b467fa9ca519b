"""Plots beside `plot`: phase plots, hodographs, polar plots, coupler curves, centrodes, circuits, workspaces, timing.

>>> import compoundkin as ck
>>> motion = ck.solve(ck.catalog.load_named("crank-rocker"))
>>> isinstance(ck.plots.polar(motion, "rocker.angular_velocity"), ck.results.Plot)
True
"""

from __future__ import annotations

from compoundkin.view.plot import centrodes, circuits, hodograph, paths, phase, polar, timing_chart, workspace

__all__ = ["centrodes", "circuits", "hodograph", "paths", "phase", "polar", "timing_chart", "workspace"]
