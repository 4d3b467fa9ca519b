"""Loads in a model: constant forces as actuators, springs and dampers of joints or between points.

Whatever is no constant, such as the pressure of a gas over the stroke, is left out and named.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from compoundkin.files.exchange.mjcf.body_elements import place, site_name
from compoundkin.files.exchange.mjcf.model_plan import ModelPlan
from compoundkin.files.exchange.shortest_numbers import shortest
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads.spring import COMPRESSION, TENSION

# The site whose axes are those of the frame.
AXES = "axes of the frame"
# A length that no spring reaches, as a part of the size.
_FAR = 1e3


class ModelLoads:
    """The loads that a model has: actuators, tendons, and what joints say. `left` names those that it has not."""

    def __init__(self, plan: ModelPlan, bodies: Mapping[str, Element]) -> None:
        self.actuators, self.tendons = Element("actuator"), Element("tendon")
        self._plan, self._bodies, self._units = plan, bodies, plan.units
        self._joints = {joint.get("name", ""): joint for joint in bodies[FRAME].iter("joint")}
        ways = {"forces": self._force, "torques": self._torque, "efforts": self._effort,
                "springs": self._spring, "dampers": self._damper}  # fmt: skip
        mechanism = plan.shown.mechanism
        loads = mechanism.loads.items()
        self.left = [name for name, load in loads if load.table not in ways or not ways[load.table](load)]
        self.left += [f"friction of {name}" for name in mechanism.frictions]
        self.left += [f"pretension of {name}" for name in mechanism.pretensions]
        if any(element.get("refsite") for element in self.actuators):
            SubElement(bodies[FRAME], "site", name=AXES, pos=place(0j))

    def _force(self, load: Any) -> bool:
        force = _constant(load.force)
        if force is None or load.while_moving is not None or load.fixed_in not in (FRAME, load.link):
            return False
        site = self._site(load.link, load.at, load.name)
        gear = f"{place(force * self._units.force)} 0 0 0"
        words = {"refsite": AXES} if load.fixed_in == FRAME else {}
        SubElement(self.actuators, "motor", {"name": load.name, "site": site, **words, "gear": gear})
        return True

    def _torque(self, load: Any) -> bool:
        torque = _constant(load.torque)
        if torque is None:
            return False
        site = self._site(load.link, 0j, load.name)
        gear = f"0 0 0 0 0 {shortest(torque.real * self._units.force * self._units.length)}"
        SubElement(self.actuators, "motor", name=load.name, site=site, gear=gear)
        return True

    def _effort(self, load: Any) -> bool:
        amount, found = _constant(load.amount), self._plan.coordinate(load.pair)
        if amount is None or found is None or load.only is not None:
            return False
        gear = shortest(found.sign * amount.real * self._effort_unit(found.joint))
        SubElement(self.actuators, "motor", name=load.name, joint=found.joint, gear=gear)
        return True

    def _spring(self, load: Any) -> bool:
        is_along = hasattr(load, "pair")
        told = (load.stiffness, load.free if is_along else load.free_length, load.preload)
        stiffness, free, preload = (_constant(value) for value in told)
        if stiffness is None or free is None or preload is None or stiffness.real <= 0.0:
            return False
        rest = (free - preload / stiffness).real
        if is_along:
            return load.only is None and self._joint_spring(load, stiffness.real, rest)
        length, far = rest * self._units.length, _FAR * self._plan.size
        ends = {TENSION: (0.0, length), COMPRESSION: (length, far)}.get(load.only, (length, length))
        pull = shortest(stiffness.real * self._units.force / self._units.length)
        return rest >= 0.0 and self._tendon(load, stiffness=pull, springlength=" ".join(shortest(end) for end in ends))

    def _joint_spring(self, load: Any, stiffness: float, rest: float) -> bool:
        found = self._plan.coordinate(load.pair)
        if found is None or self._joints[found.joint].get("stiffness"):
            return False
        unit = self._plan.unit_of(found.joint)
        self._joints[found.joint].set("stiffness", shortest(stiffness * self._effort_unit(found.joint) / unit))
        self._joints[found.joint].set("springref", shortest(found.sign * (rest - found.drawn) * unit))
        return True

    def _damper(self, load: Any) -> bool:
        rate = _constant(load.rate)
        if rate is None:
            return False
        if not hasattr(load, "pair"):
            return self._tendon(load, damping=shortest(rate.real * self._units.force / self._units.length))
        found = self._plan.coordinate(load.pair)
        if found is None or self._joints[found.joint].get("damping"):
            return False
        scale = self._effort_unit(found.joint) / self._plan.unit_of(found.joint)
        self._joints[found.joint].set("damping", shortest(rate.real * scale))
        return True

    def _tendon(self, load: Any, **words: str) -> bool:
        """Add a tendon between the two ends of a load."""
        spatial = SubElement(self.tendons, "spatial", {"name": load.name, **words})
        for link, own in ((load.link, load.point), (load.to, load.at)):
            SubElement(spatial, "site", site=self._site(link, own, f"{load.name} on {link}"))
        return True

    def _site(self, link: str, own: str | complex, name: str) -> str:
        """Return the site at a point of a link, a new one where the point has no letter."""
        if isinstance(own, str):
            return site_name(self._plan, own, link)
        SubElement(self._bodies[link], "site", name=name, pos=place(complex(own) * self._units.length))
        return name

    def _effort_unit(self, joint: str) -> float:
        """Return how much a unit of effort along a joint is in the model."""
        return self._units.force * (self._units.length if self._plan.joints[joint].is_hinge else 1.0)


def _constant(amount: Any) -> complex | None:
    """Return an amount that is one number, or None."""
    is_number = isinstance(amount, int | float | complex) or (isinstance(amount, np.ndarray) and amount.size == 1)
    return complex(np.ravel(amount)[0]) if is_number else None
