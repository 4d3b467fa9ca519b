"""Mechanical advantage as a ratio of forces: what a driver needs to hold a load, with the friction there is."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from compoundkin.analysis.mechanical_advantage import ForcePort, Port, TorquePort, mechanical_advantage
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dynamics.drives.driver_course import driver_named
from compoundkin.dynamics.force_analysis import force_analysis
from compoundkin.kinematics.motion import Motion
from compoundkin.model.elements import Expectation, Item
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads import effort, force, torque
from compoundkin.model.loads.contract import Load
from compoundkin.model.loads.gravity import Gravity
from compoundkin.model.loads.mass import Mass
from compoundkin.model.loads.pretension import Pretension
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.units import Units

# A ratio of forces does not depend on units; a mechanism without any is given these.
ANY_UNITS = Units("m", "kg", "N")


@checked
def force_ratio(motion: Motion, output: Port, driver: str | None = None) -> Number:
    """Return how many times a driver's effort is available at an output.

    At every pose, of the only driver without a name. Outputs are those of `mechanical_advantage`: a link, a pair or a
    driver by name, a `TorquePort` or a `ForcePort`. Only friction acts beside a load there, neither weights nor masses
    nor other loads; without friction it is the mechanical advantage by rates, with it less. Infinite where the load
    needs no effort.

    Raises UnknownName and InvalidInput as `mechanical_advantage`.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> motion = solve(load_named("four-bar-norton"), {"crank": [np.deg2rad(40)]})
    >>> force_ratio(motion, "rocker").round(3).tolist()        # Norton: 25 / 6.998
    [3.572]
    """
    name = driver_named(motion, driver)
    by_rates = mechanical_advantage(motion, output, name)
    # against the output's motion; at a toggle position, where it rests, any load needs no effort
    load = -np.where(by_rates.velocity_ratio * np.sign(motion.drives[name].rate) < 0.0, -1.0, 1.0)
    mechanism = motion.mechanism
    items = [item for item in mechanism.items if not isinstance(item, Mass | Gravity | Load | Pretension | Expectation)]
    loaded = Mechanism(mechanism.title, *items, *_resisting(motion, output, load), units=mechanism.units or ANY_UNITS)
    forces = force_analysis(replace(motion, structure=replace(motion.structure, mechanism=loaded)), inertia=False)
    with np.errstate(divide="ignore"):
        found = -load / np.asarray(forces.drives[name].effort)
    return np.where(by_rates.output_rests, np.inf, found)


def _resisting(motion: Motion, output: Port, load: Number) -> Iterator[Item]:
    """Yield a load at an output, and its opposite on the link against which it acts."""
    if isinstance(output, str):
        is_link = output in motion.links and output not in motion.structure.translating_links
        yield torque(output, load) if is_link else effort(output, load)
    elif isinstance(output, TorquePort):
        yield torque(output.link, load)
        if output.on != FRAME:
            yield torque(output.on, -load, name="opposite")
    else:
        yield from _resisting_force(output, load)


def _resisting_force(output: ForcePort, load: Number) -> Iterator[Item]:
    if output.on != FRAME:
        remedy = "take a pair between the two links, or the frame"
        raise InvalidInput(Problem("output.on", "a force against a moving link has no fixed point on it", remedy))
    yield force(output.link, load * np.exp(1j * np.asarray(output.angle, dtype=float)), at=output.point)
