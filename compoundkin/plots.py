"""Plots beside `plot`: phase, polar, bearing loads, paths, centrodes, circuits, timing; studies, tolerances, searches.

>>> import compoundkin as ck
>>> motion = ck.solve(ck.load("crank-rocker"))
>>> isinstance(ck.plots.polar(motion, "rocker.angular_velocity"), ck.results.Plot)
True
"""

from __future__ import annotations

from compoundkin.view.plot import (
    bands,
    bar_diagrams,
    bearing_loads,
    centrodes,
    circuits,
    contributions,
    histogram,
    hodograph,
    improvement,
    motor_curves,
    pareto,
    paths,
    phase,
    polar,
    scatter_matrix,
    starts,
    timing_chart,
    workspace,
)

__all__ = [
    "bands",
    "bar_diagrams",
    "bearing_loads",
    "centrodes",
    "circuits",
    "contributions",
    "histogram",
    "hodograph",
    "improvement",
    "motor_curves",
    "pareto",
    "paths",
    "phase",
    "polar",
    "scatter_matrix",
    "starts",
    "timing_chart",
    "workspace",
]
