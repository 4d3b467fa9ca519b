"""What stands before the bodies of a model: how it is stepped, how hard its constraints are, where it is seen from."""

from __future__ import annotations

from collections.abc import Iterator
from math import radians, tan
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from compoundkin.base.arrays import TURN, first_entry
from compoundkin.base.display import printable
from compoundkin.files.exchange.mjcf.body_elements import place
from compoundkin.files.exchange.mjcf.driver_elements import fastest
from compoundkin.files.exchange.mjcf.model_plan import ModelPlan
from compoundkin.files.exchange.shortest_numbers import shortest

# The longest step (seconds), and how many make a turn of the fastest driver, or a way of six sizes.
_LONGEST, _STEPS = 2.5e-4, 2000
# In how many steps constraints catch up. Two are the least in MuJoCo, which suit where nothing moves fast beside the
# driver; with eight all shipped mechanisms run.
_OF_CONSTRAINTS = 8.0
# How hard constraints are, between MuJoCo's own 0.9 to 0.95 and 1: they stand for pairs.
_HARD = "0.99 0.999 0.001"
# What the camera sees: an angle (degrees), and so many times what is drawn.
_ANGLE, _ROOM = 30.0, 1.2
# The radius of points, by the mechanism's size.
_POINT = 0.006


def step_of(plan: ModelPlan) -> float:
    """Return the step of a model in seconds."""
    rate = fastest(plan)
    return min(_LONGEST, TURN / rate / _STEPS) if rate else _LONGEST


def settings(plan: ModelPlan, notes: tuple[str, ...]) -> Iterator[Element]:
    """Yield what stands before the bodies. The notes are in it, as texts."""
    yield Element("compiler", angle="radian", autolimits="true")
    fall, step = complex(first_entry(plan.shown.mechanism.gravity)), step_of(plan)
    option = Element("option", timestep=shortest(step), integrator="implicitfast", gravity=place(fall))
    SubElement(option, "flag", contact="disable")
    yield option
    middle, width = _view(plan)
    yield Element("statistic", center=place(middle), extent=shortest(width))
    defaults = Element("default")
    SubElement(defaults, "equality", solref=f"{shortest(_OF_CONSTRAINTS * step)} 1", solimp=_HARD)
    SubElement(defaults, "geom", contype="0", conaffinity="0")
    SubElement(defaults, "site", size=shortest(_POINT * plan.size))
    yield defaults
    yield from _looks()
    custom = Element("custom")
    for k, note in enumerate(notes):
        SubElement(custom, "text", name=f"note {k + 1}", data=printable(note))
    yield custom


def _looks() -> Iterator[Element]:
    """Yield light from the eye, and a bright background."""
    visual, asset = Element("visual"), Element("asset")
    SubElement(visual, "headlight", ambient="0.5 0.5 0.5", diffuse="0.5 0.5 0.5", specular="0.1 0.1 0.1")
    SubElement(asset, "texture", type="skybox", builtin="flat", rgb1="1 1 1", rgb2="1 1 1", width="8", height="8")
    yield from (visual, asset)


def camera(plan: ModelPlan) -> Element:
    """Return a camera that looks at the plane, y being up."""
    middle, width = _view(plan)
    height = _ROOM * width / 2.0 / tan(radians(_ANGLE / 2.0))
    at = f"{shortest(middle.real)} {shortest(middle.imag)} {shortest(height)}"
    return Element("camera", name="plane", pos=at, xyaxes="1 0 0 0 1 0", fovy=shortest(_ANGLE))


def _view(plan: ModelPlan) -> tuple[complex, float]:
    """Return the middle and the width of what is seen: of all poses, where they are known."""
    shown = plan.shown
    seen = np.array([shown.place(link, own) for link, points in shown.points.items() for own in points.values()])
    if shown.motion is not None:
        moved = [np.ravel(shown.motion.points[letter].position) for letter in shown.mechanism.carriers]
        seen = np.concatenate([seen, *moved])
    found = seen * plan.units.length
    sides = [(np.nanmin(part), np.nanmax(part)) for part in (found.real, found.imag)]
    middle = complex(*(float(low + high) / 2.0 for low, high in sides))
    return middle, float(max(*(high - low for low, high in sides), 0.1 * plan.size))
