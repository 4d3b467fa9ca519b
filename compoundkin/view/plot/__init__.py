"""Plots of motions and studies, drawn with Matplotlib, which is loaded when the first one is drawn."""

from compoundkin.view.plot.bar_diagrams import bar_diagrams
from compoundkin.view.plot.circuit_plot import circuits
from compoundkin.view.plot.motor_plot import motor_curves
from compoundkin.view.plot.optimisation_plots import improvement, starts
from compoundkin.view.plot.plane_plots import bearing_loads, centrodes, hodograph, paths, phase, polar
from compoundkin.view.plot.plot_style import Plot
from compoundkin.view.plot.quantity_plot import plot
from compoundkin.view.plot.scatter_plots import pareto, scatter_matrix
from compoundkin.view.plot.study_plot import bands, contributions, histogram
from compoundkin.view.plot.timing_chart import timing_chart
from compoundkin.view.plot.workspace_plot import workspace

__all__ = [
    "Plot",
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
    "plot",
    "polar",
    "scatter_matrix",
    "starts",
    "timing_chart",
    "workspace",
]
