"""The drivers of a model: an actuator each that holds its speed, and a keyframe of the pose as drawn in motion."""

from __future__ import annotations

from collections.abc import Iterator
from xml.etree.ElementTree import Element, SubElement

from compoundkin.base.arrays import first_entry
from compoundkin.files.exchange.mjcf.body_elements import number
from compoundkin.files.exchange.mjcf.joint_rates import joint_rates
from compoundkin.files.exchange.mjcf.model_plan import ModelPlan

# The drawn pose in motion: what the keyframe is called.
KEYFRAME = "drawn"


def driver_elements(plan: ModelPlan, world: Element, stiffness: float) -> Iterator[Element]:
    """Yield the actuators and the keyframe. `stiffness` is how many times a second a driver could catch up."""
    actuators = Element("actuator")
    speeds = dict(_speeds(plan))
    for name, (joint, _) in speeds.items():
        lever = plan.size**2 if plan.joints[joint].is_hinge else 1.0
        weight = sum(mass.mass for mass in plan.masses.values()) * lever
        SubElement(actuators, "velocity", name=name, joint=joint, kv=number(weight * stiffness))
    if speeds:
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
    if speeds:
        key.set("ctrl", " ".join(number(speed) for _, speed in speeds.values()))
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
