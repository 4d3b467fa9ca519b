"""Plots of motions, drawn with Matplotlib, which is loaded when the first one is drawn."""

from compoundkin.plots.circuits import circuits
from compoundkin.plots.coupler_curves import paths
from compoundkin.plots.hodographs import hodograph
from compoundkin.plots.over import plot
from compoundkin.plots.phases import phase
from compoundkin.plots.picture import Plot
from compoundkin.plots.polars import polar
from compoundkin.plots.rolling import centrodes

__all__ = ["Plot", "centrodes", "circuits", "hodograph", "paths", "phase", "plot", "polar"]
