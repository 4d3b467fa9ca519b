"""The drivers of a model: an actuator each that holds its speed, and a keyframe of the pose as drawn in motion."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from compoundkin.base.arrays import first_entry
from compoundkin.base.poses import Pose
from compoundkin.files.exchange.mjcf.body_elements import number
from compoundkin.files.exchange.mjcf.joint_tree import CarriedLink
from compoundkin.files.exchange.mjcf.model_plan import ModelPlan

# The drawn pose in motion: what the keyframe is called.
KEYFRAME = "drawn"


def driver_elements(plan: ModelPlan, world: Element, loads: Element, stiffness: float) -> Iterator[Element]:
    """Yield the actuators, those of loads last, and the keyframe.

    `stiffness` is how many times a second a driver could catch up.
    """
    actuators = Element("actuator")
    speeds = dict(_speeds(plan))
    for name, (joint, _) in speeds.items():
        lever = plan.size**2 if plan.joints[joint].is_hinge else 1.0
        weight = sum(mass.mass for mass in plan.masses.values()) * lever
        SubElement(actuators, "velocity", name=name, joint=joint, kv=number(weight * stiffness))
    actuators.extend(loads)
    if len(actuators):
        yield actuators
    rates = joint_rates(plan)
    names = [joint.get("name", "") for joint in world.iter("joint")]
    frames = Element("keyframe")
    key = SubElement(
        frames,
        "key",
        name=KEYFRAME,
        qpos=" ".join(["0"] * len(names)),
        qvel=" ".join(number(rates[name] * plan.unit_of(name)) for name in names),
    )
    if len(actuators):
        # what a load pulls is in its gear
        key.set("ctrl", " ".join([*(number(speed) for _, speed in speeds.values()), *["1"] * len(loads)]))
    yield frames


def _speeds(plan: ModelPlan) -> Iterator[tuple[str, tuple[str, float]]]:
    """Yield the drivers with their joints and the speeds of these, in the model's units."""
    signs = {branch.chain.pair.name: branch.sign for branch, _ in plan.bodies.values()}
    for name, step in plan.shown.structure.driven.items():
        joint = step.pair.name
        speed = plan.shown.rates.get(name, float(first_entry(step.drive.speed)))
        sign = signs[joint] * step.pair.driven_by(step.drive.link)
        yield name, (joint, sign * speed * plan.unit_of(joint))


def fastest(plan: ModelPlan) -> float:
    """Return the rate of the fastest driver: radians a second, or sizes a second."""
    rates = [abs(speed) / (1.0 if plan.joints[joint].is_hinge else plan.size) for _, (joint, speed) in _speeds(plan)]
    return max(rates, default=0.0)


def joint_rates(plan: ModelPlan) -> Mapping[str, float]:
    """Return the rates of all joints; zeros where some are not known.

    They are in radians or the mechanism's lengths a second.

    >>> from compoundkin.files.exchange.mjcf.model_plan import plan_of
    >>> from compoundkin.files.exchange.shown_mechanism import shown_mechanism
    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> round(joint_rates(plan_of(shown_mechanism(load_named("slider-crank"))))["O"], 9)
    1.6
    """
    found = {name: rate for branch, link in plan.bodies.values() for name, rate in _rates(plan, branch, link)}
    known = plan.shown.motion is not None and all(np.isfinite(rate) for rate in found.values())
    return found if known else dict.fromkeys(plan.joints, 0.0)


def _rates(plan: ModelPlan, branch: CarriedLink, link: str) -> Iterator[tuple[str, float]]:
    """Yield the rates of a body's joints: together they give its motion relative to its parent."""
    at = complex(plan.shown.poses[link].z.c[0])
    (turn, shift), (before, carried) = (_moved(plan.shown.poses[name], at) for name in (link, branch.parent))
    columns = [(1.0, 1j * (at - joint.axis)) if joint.is_hinge else (0.0, joint.axis) for joint in branch.joints]
    matrix = np.array([[w for w, _ in columns], [v.real for _, v in columns], [v.imag for _, v in columns]])
    right = np.array([turn - before, (shift - carried).real, (shift - carried).imag])
    if not np.all(np.isfinite(right)):
        yield from ((joint.name, np.nan) for joint in branch.joints)
        return
    # turns and shifts do not compare; each joint has one of them that the others have not
    rates = np.linalg.lstsq(matrix, right, rcond=None)[0]
    yield from ((joint.name, float(rate)) for joint, rate in zip(branch.joints, rates, strict=True))


def _moved(pose: Pose, at: complex) -> tuple[float, complex]:
    """Return how fast a link turns, and the velocity of its point at a place."""
    rates = [complex(part.c[1]) if part.order else 0j for part in (pose.z, pose.u)]
    turning = (rates[1] * complex(pose.u.c[0]).conjugate()).imag
    return turning, rates[0] + 1j * turning * (at - complex(pose.z.c[0]))
