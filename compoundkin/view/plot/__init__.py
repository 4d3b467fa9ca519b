"""Plots of motions, drawn with Matplotlib, which is loaded when the first one is drawn."""

from compoundkin.view.plot.centrode_plot import centrodes
from compoundkin.view.plot.circuit_plot import circuits
from compoundkin.view.plot.coupler_plot import paths
from compoundkin.view.plot.hodograph_plot import hodograph
from compoundkin.view.plot.phase_plot import phase
from compoundkin.view.plot.plot_picture import Plot
from compoundkin.view.plot.polar_plot import polar
from compoundkin.view.plot.quantity_plot import plot

__all__ = ["Plot", "centrodes", "circuits", "hodograph", "paths", "phase", "plot", "polar"]
