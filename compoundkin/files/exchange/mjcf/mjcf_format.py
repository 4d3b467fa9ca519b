"""MuJoCo's XML files: a mechanism as a model with joints at zero in the pose as drawn."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import Any, ClassVar
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from compoundkin.base.arrays import TURN, first_entry
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.contract import Writable
from compoundkin.files.exchange.exchanged import Exported
from compoundkin.files.exchange.mjcf.body_elements import number, place, world_element
from compoundkin.files.exchange.mjcf.constraint_elements import constraint_elements
from compoundkin.files.exchange.mjcf.driver_elements import driver_elements, fastest
from compoundkin.files.exchange.mjcf.model_plan import ModelPlan, plan_of
from compoundkin.files.exchange.shown_mechanism import ShownMechanism

# The longest step (seconds), and how many make a turn of the fastest driver, or a way of six sizes.
_LONGEST, _STEPS = 1e-3, 2000
# Constraints and drivers catch up in so many steps: two is the least that MuJoCo takes as asked for.
_CATCH_UP = 2.0
# How hard constraints are, from MuJoCo's 0.9 to 0.95 where they are soft to 1: they stand for pairs.
_HARD = "0.999 0.9999 0.001"
# MuJoCo's own name of the frame.
_WORLD = "world"


class MjcfFormat(Writable):
    """MuJoCo's models. They are written, not read."""

    name: ClassVar[str] = "mjcf"
    program: ClassVar[str] = "MuJoCo"
    title: ClassVar[str] = "a MuJoCo model (MJCF)"
    suffix: ClassVar[str] = ".xml"

    def write(self, shown: ShownMechanism, **options: Any) -> Exported:
        """Return the model. Raises InvalidInput listing all that hinges, slides and their sums cannot say.

        >>> from compoundkin.files.exchange.shown_mechanism import shown_mechanism
        >>> from compoundkin.files.shipped_mechanisms import load_named
        >>> found = FORMAT.write(shown_mechanism(load_named("slider-crank")))
        >>> found.text.count("<body "), found.text.count("<connect ")
        (3, 1)
        """
        plan = plan_of(shown)
        notes = (*_notes(plan), *plan.notes)
        model = _model(plan, notes)
        indent(model)
        return Exported(tostring(model, "utf-8", xml_declaration=False) + b"\n", self.name, notes)


def _model(plan: ModelPlan, notes: tuple[str, ...]) -> Element:
    """Return the whole model."""
    mechanism, world = plan.shown.mechanism, world_element(plan)
    _hold_names(world)
    model = Element("mujoco", model=_printable(mechanism.title))
    SubElement(model, "compiler", angle="radian", autolimits="true")
    rate = fastest(plan)
    step = min(_LONGEST, TURN / rate / _STEPS) if rate else _LONGEST
    fall = complex(first_entry(mechanism.gravity))
    option = SubElement(model, "option", timestep=number(step), integrator="implicitfast", gravity=place(fall))
    SubElement(option, "flag", contact="disable")
    defaults = SubElement(model, "default")
    SubElement(defaults, "equality", solref=f"{number(_CATCH_UP * step)} 1", solimp=_HARD)
    custom = SubElement(model, "custom")
    for k, note in enumerate(notes):
        SubElement(custom, "text", name=f"note {k + 1}", data=_printable(note))
    model.append(world)
    model.extend(constraint_elements(plan))
    model.extend(driver_elements(plan, world, 1.0 / (_CATCH_UP * step)))
    return model


def _notes(plan: ModelPlan) -> Iterator[str]:
    """Yield in sentences what the numbers mean, and what of the mechanism is left out."""
    yield plan.units.told
    mechanism = plan.shown.mechanism
    laws = [drive.name for drive in mechanism.drives if drive.law is not None]
    if laws:
        yield f"laws of time are not in a model: {', '.join(laws)} keeps the speed of this pose"
    for free in plan.shown.structure.passive:
        yield f"{free}: nothing holds that in a model"
    left = Counter(item.title for item in mechanism.loads.values())
    left.update({"friction": len(mechanism.frictions), "pretension": len(mechanism.pretensions)})
    told = [f"{title} ({count})" for title, count in left.items() if count]
    if told:
        yield f"left out: {', '.join(told)}"


def _hold_names(world: Element) -> None:
    """Raise InvalidInput where two bodies, joints or points would have one name."""
    named = Counter((element.tag, element.get("name", "")) for element in world.iter() if element.get("name"))
    named["body", _WORLD] += 1
    twice = [Problem(name, f"two of one name: {tag}") for (tag, name), count in named.items() if count > 1]
    if twice:
        raise InvalidInput(twice, heading="a model of MuJoCo has every name once")


def _printable(text: str) -> str:
    return "".join(c if c.isprintable() else " " for c in text)


FORMAT = MjcfFormat()
