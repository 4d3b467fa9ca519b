"""The drivers of a model: an actuator each that holds its speed, and a keyframe of the pose as drawn in motion."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from compoundkin.base.arrays import TURN, Number, first_entry
from compoundkin.base.poses import Pose
from compoundkin.files.exchange.mjcf.joint_tree import CarriedLink
from compoundkin.files.exchange.mjcf.model_plan import ModelPlan
from compoundkin.files.exchange.shortest_numbers import shortest

# The drawn pose in motion: what the keyframe is called.
KEYFRAME = "drawn"
# A driver that turns as far but for so much of it makes full turns.
_ROUNDING = 1e-9


def driver_elements(plan: ModelPlan, world: Element, loads: Element, lag: float) -> Iterator[Element]:
    """Yield the actuators, those of loads last, and the keyframe.

    A driver is drawn by a critically damped spring toward a place that moves with its speed; `lag` is the time
    constant of that in seconds. It stops at the ends of the range over which the mechanism is solved.
    """
    actuators, key = Element("actuator"), Element("key", name=KEYFRAME)
    speeds = dict(_speeds(plan))
    for name, (joint, _) in speeds.items():
        weight = moved_mass(plan, name, joint)
        words = {"kp": shortest(weight / lag**2), "kv": shortest(2.0 * weight / lag)}
        ends = _range(plan, name, joint)
        words |= {"actrange": " ".join(shortest(end) for end in ends)} if ends else {}
        SubElement(actuators, "intvelocity", {"name": name, "joint": joint, **words})
    actuators.extend(loads)
    rates, joints = joint_rates(plan), [joint.get("name", "") for joint in world.iter("joint")]
    key.set("qpos", " ".join(["0"] * len(joints)))
    key.set("qvel", " ".join(shortest(rates[name] * plan.unit_of(name)) for name in joints))
    if len(actuators):
        # what a load pulls is in its gear; a place that is ahead of its driver draws it with the right speed
        key.set("ctrl", " ".join([*(shortest(speed) for _, speed in speeds.values()), *["1"] * len(loads)]))
        key.set("act", " ".join(shortest(2.0 * lag * speed) for _, speed in speeds.values()))
        yield actuators
    frames = Element("keyframe")
    frames.append(key)
    yield frames


def moved_mass(plan: ModelPlan, name: str, joint: str) -> float:
    """Return the mass or inertia of all links as a driver feels it.

    It is the median over the poses. That is twice their energy by the square of its speed;
    where it is not known, that of all masses at the size.
    """
    motion, total = plan.shown.motion, sum(mass.mass for mass in plan.masses.values())
    rough = total * (plan.size**2 if plan.joints[joint].is_hinge else 1.0)
    if motion is None:
        return rough
    energy: Number = 0.0
    for link, own in plan.masses.items():
        pose, length = motion.poses[link], plan.units.length
        turning = (pose.derivative(1.0, 1) - pose.derivative(0.0, 1)) * np.conjugate(pose.u.c[0])
        energy = energy + own.mass * np.abs(pose.derivative(own.centre / length, 1) * length) ** 2
        energy = energy + own.inertia * turning.imag**2
    rate = np.ravel(motion.drives[name].rate) * plan.unit_of(joint)
    with np.errstate(all="ignore"):
        felt = np.ravel(energy) / rate**2
    known = felt[np.isfinite(felt) & (felt > 0.0)]
    found = float(np.median(known)) if known.size else rough
    # the energy is that of all drivers together
    return min(found, rough) if len(plan.shown.values) > 1 else found


def _range(plan: ModelPlan, name: str, joint: str) -> tuple[float, float] | None:
    """Return from where to where a driver's joint may go; None where it makes full turns, or is known at a pose."""
    motion = plan.shown.motion
    if motion is None or motion.inputs.poses < 2:
        return None
    values = np.broadcast_to(np.ravel(motion.drives[name].value), motion.assembled.shape).ravel()
    drawn, solved = plan.shown.values[name], np.ravel(motion.assembled)
    if solved.all() and plan.joints[joint].is_hinge and np.ptp(values) >= TURN * (1.0 - _ROUNDING):
        return None
    # of several ranges that in which it is drawn
    at = int(np.argmin(np.where(solved, np.abs(values - drawn), np.inf)))
    gaps = np.flatnonzero(~solved)
    run = values[gaps[gaps < at].max(initial=-1) + 1 : gaps[gaps > at].min(initial=values.size)]
    sign = dict(_signs(plan))[name]
    ways = sign * (np.append(run, drawn) - drawn) * plan.unit_of(joint)
    return (float(ways.min()), float(ways.max())) if np.ptp(ways) > 0.0 else None


def _signs(plan: ModelPlan) -> Iterator[tuple[str, int]]:
    """Yield the drivers with 1 or -1, as their joints move with them."""
    signs = {own.chain.pair.name: own.sign for own, _ in plan.bodies.values()}
    for name, step in plan.shown.structure.driven.items():
        yield name, signs[step.pair.name] * step.pair.driven_by(step.drive.link)


def _speeds(plan: ModelPlan) -> Iterator[tuple[str, tuple[str, float]]]:
    """Yield the drivers with their joints and the speeds of these, in the model's units."""
    for name, sign in _signs(plan):
        step = plan.shown.structure.driven[name]
        joint = step.pair.name
        speed = plan.shown.rates.get(name, float(first_entry(step.drive.speed)))
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
    >>> from compoundkin.files import load
    >>> round(joint_rates(plan_of(shown_mechanism(load("slider-crank"))))["O"], 9)
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
