"""MuJoCo's XML files: a mechanism as a model with joints at zero in the pose as drawn."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar
from xml.etree.ElementTree import Element, indent, tostring

from compoundkin.base.display import printable
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.contract import Writable
from compoundkin.files.exchange.exchanged import Exported
from compoundkin.files.exchange.mjcf.body_elements import body_elements
from compoundkin.files.exchange.mjcf.body_shapes import add_shapes
from compoundkin.files.exchange.mjcf.constraint_elements import constraint_elements
from compoundkin.files.exchange.mjcf.driver_elements import driver_elements
from compoundkin.files.exchange.mjcf.load_elements import ModelLoads
from compoundkin.files.exchange.mjcf.model_plan import ModelPlan, plan_of
from compoundkin.files.exchange.mjcf.model_settings import camera, settings, step_of
from compoundkin.files.exchange.shown_mechanism import ShownMechanism
from compoundkin.model.geometry import FRAME

# In how many steps drivers catch up.
_OF_DRIVERS = 16.0
# MuJoCo's own name of the frame.
_WORLD = "world"


class MjcfFormat(Writable):
    """MuJoCo's models. They are written, not read."""

    name: ClassVar[str] = "mjcf"
    program: ClassVar[str] = "MuJoCo"
    title: ClassVar[str] = "MuJoCo model (MJCF)"
    suffix: ClassVar[str] = ".xml"

    def write(self, shown: ShownMechanism, **options: Any) -> Exported:
        """Return the model. Raises InvalidInput listing all that hinges, slides and their sums cannot say.

        >>> from compoundkin.files.exchange.shown_mechanism import shown_mechanism
        >>> from compoundkin.files import load
        >>> found = FORMAT.write(shown_mechanism(load("slider-crank")))
        >>> found.text.count("<body "), found.text.count("<connect ")
        (3, 1)
        """
        plan = plan_of(shown)
        bodies = body_elements(plan)
        loads = ModelLoads(plan, bodies)
        notes = (*_notes(plan, loads.left), *plan.notes)
        model = _model(plan, bodies, loads, notes)
        indent(model)
        return Exported(tostring(model, "utf-8", xml_declaration=False) + b"\n", self.name, notes)


def _model(plan: ModelPlan, bodies: Mapping[str, Element], loads: ModelLoads, notes: tuple[str, ...]) -> Element:
    """Return the whole model."""
    world = bodies[FRAME]
    add_shapes(plan, bodies)
    world.append(camera(plan))
    model = Element("mujoco", model=printable(plan.shown.mechanism.title))
    model.extend(settings(plan, notes))
    model.append(world)
    model.extend(constraint_elements(plan, loads.tendons))
    model.extend(driver_elements(plan, world, loads.actuators, _OF_DRIVERS * step_of(plan)))
    _hold_names(model)
    return model


def _notes(plan: ModelPlan, left: list[str]) -> Iterator[str]:
    """Yield in sentences what the numbers mean, and what of the mechanism is left out."""
    yield plan.units.told
    laws = [drive.name for drive in plan.shown.mechanism.drives if drive.law is not None]
    if laws:
        yield f"laws of time are not in a model: {', '.join(laws)} keeps the speed of this pose"
    for free in plan.shown.structure.passive:
        yield f"{free}: it is held as it is drawn"
    if left:
        yield f"loads that no model says are left out: {', '.join(left)}"


def _hold_names(model: Element) -> None:
    """Raise InvalidInput where two elements of one sort would have one name."""
    named = Counter({("body", _WORLD): 1})
    for section in model:
        within = section.iter() if section.tag == "worldbody" else iter(section)
        sort = "" if section.tag == "worldbody" else section.tag
        named.update((sort or own.tag, own.get("name", "")) for own in within if own.get("name"))
    twice = [
        Problem(name, f"two of one name: {sort}", "call one of them otherwise")
        for (sort, name), count in named.items()
        if count > 1
    ]
    if twice:
        raise InvalidInput(twice, heading="a model of MuJoCo has every name once")


FORMAT = MjcfFormat()
