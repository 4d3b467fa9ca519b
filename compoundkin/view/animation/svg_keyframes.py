"""Keyframes as attributes of SVG: groups that are moved and turned. Source: W3C, SMIL Animation, 2001."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import whole_turns
from compoundkin.base.series import Number
from compoundkin.view.animation.keyframes import DEVIATION, Keys, keys_of, short
from compoundkin.view.animation.timeline import Timeline

# Digits after the point: of times in parts of the whole, of places, of degrees.
OF_TIMES, OF_PLACES, OF_DEGREES = 5, 2, 2
# What is not on the picture waits here.
AWAY = -1000.0 - 1000.0j


@dataclass(frozen=True, eq=False)
class Writer:
    """Writes keyframes of a timeline; `one_by_one` where poses are shown so."""

    timeline: Timeline
    one_by_one: bool

    def keys(self, values: Number, deviation: float = DEVIATION, shown: Number | None = None) -> Keys:
        """The keyframes of values at the poses of the timeline."""
        return keys_of(self.timeline, values, deviation, self.one_by_one, shown, AWAY)

    def timing(self, keys: Keys, written: Callable[[Number], str]) -> str:
        """The attributes that say which values there are when."""
        words = [f'dur="{short(self.timeline.seconds, 3)}s" repeatCount="indefinite"']
        words += ['calcMode="discrete"'] if keys.is_steady else []
        words += [] if keys.is_even else [f'keyTimes="{";".join(short(float(t), OF_TIMES) for t in keys.times)}"']
        return " ".join([*words, f'values="{";".join(map(written, keys.values))}"'])

    def moving(self, kind: str, keys: Keys, written: Callable[[Number], str], inside: list[str]) -> list[str]:
        """Elements in a group that is moved ("translate") or turned ("rotate") by keyframes."""
        first = written(keys.values[0])
        if len(keys.times) == 1:
            return [f'<g transform="{kind}({first})">', *inside, "</g>"] if first.strip("0 ") else inside
        how = f'<animateTransform attributeName="transform" type="{kind}" {self.timing(keys, written)}/>'
        return [f'<g transform="{kind}({first})">', how, *inside, "</g>"]

    def translated(self, places: Number, inside: list[str], shown: Number | None = None) -> list[str]:
        """Elements moved along places at the poses of the timeline."""
        return self.moving("translate", self.keys(places, shown=shown), place, inside)

    def turned(self, angles: Number, deviation: float, inside: list[str]) -> list[str]:
        """Elements turned by angles over the assembled poses, radians, clockwise on the picture."""
        return self.moving("rotate", self.turns(angles, deviation), _degrees, inside)

    def turns(self, angles: Number, deviation: float) -> Keys:
        """The keyframes of those angles, in degrees."""
        shown = np.rad2deg(self.timeline.turning(angles))
        return self.keys(shown - whole_turns(shown[0], 360.0), np.rad2deg(deviation))


def place(value: Number) -> str:
    """A place as the specification of SVG has it."""
    return f"{short(float(value[0].real), OF_PLACES)} {short(float(value[0].imag), OF_PLACES)}"


def _degrees(value: Number) -> str:
    return short(float(value[0].real), OF_DEGREES)
