"""Plots beside `plot`: phase and polar plots, hodographs, bearing loads, coupler curves, centrodes, circuits, timing.

>>> import compoundkin as ck
>>> motion = ck.solve(ck.catalog.load_named("crank-rocker"))
>>> isinstance(ck.plots.polar(motion, "rocker.angular_velocity"), ck.results.Plot)
True
"""

from __future__ import annotations

from compoundkin.view.plot import (
    bearing_loads,
    centrodes,
    circuits,
    hodograph,
    paths,
    phase,
    polar,
    timing_chart,
    workspace,
)

__all__ = [
    "bearing_loads",
    "centrodes",
    "circuits",
    "hodograph",
    "paths",
    "phase",
    "polar",
    "timing_chart",
    "workspace",
]
