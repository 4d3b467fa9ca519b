"""Plots of motions and studies, drawn with Matplotlib, which is loaded when the first one is drawn."""

from compoundkin.view.plot.bearing_loads import bearing_loads
from compoundkin.view.plot.circuit_plot import circuits
from compoundkin.view.plot.contribution_bars import contributions
from compoundkin.view.plot.curve_plots import hodograph, phase, polar
from compoundkin.view.plot.figure_histogram import histogram
from compoundkin.view.plot.improvement_plot import improvement
from compoundkin.view.plot.pareto_plot import pareto
from compoundkin.view.plot.path_plots import centrodes, paths
from compoundkin.view.plot.percentile_bands import bands
from compoundkin.view.plot.plot_style import Plot
from compoundkin.view.plot.quantity_plot import plot
from compoundkin.view.plot.scatter_matrix import scatter_matrix
from compoundkin.view.plot.search_ends import starts
from compoundkin.view.plot.timing_chart import timing_chart
from compoundkin.view.plot.workspace_plot import workspace

__all__ = [
    "Plot",
    "bands",
    "bearing_loads",
    "centrodes",
    "circuits",
    "contributions",
    "histogram",
    "hodograph",
    "improvement",
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
