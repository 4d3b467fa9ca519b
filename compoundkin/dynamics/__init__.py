"""Forces and dynamics: reactions group by group, friction, power, balance, simulation.

The reverse pass visits the groups from the last to the first: when one is reached, all other forces on its links are
known, and its reactions are one small system (`GroupSolver.reactions`). Dyads have closed forms, any other group the
transposed Jacobian from the `wrenches` of its pairs; contract tests compare both. A `LoadedBlock` is a block of a
motion as loads see it; loads know neither groups nor motions. Reactions are linear in the loads: one pass for each
friction gives its influence on all normal forces, and Coulomb's law is solved for all poses at once. Forces that a
state of self-stress may change are undetermined: NaN, and named.

Efforts are computed a second time by virtual work at unit rates, without reactions; `verify(forces)` starts from the
accelerations of the links. The equation of motion is in the drivers' coordinates, so that no constraints can drift;
with one degree of freedom it is a table over the coordinate. All numbers are in the mechanism's units except gravity,
which is written in m/s^2.
"""

from compoundkin.base import display

display.register(
    forces="compoundkin.dynamics.force_analysis:force_analysis",
    force_figure="compoundkin.dynamics.reactions.force_figures:force_figure",
)
