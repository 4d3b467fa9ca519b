"""Forces and dynamics: reactions group by group, friction, power, balance, simulation."""

from compoundkin.base import display

display.register(
    forces="compoundkin.dynamics.force_analysis:force_analysis",
    force_figure="compoundkin.dynamics.reactions.force_figures:force_figure",
)
