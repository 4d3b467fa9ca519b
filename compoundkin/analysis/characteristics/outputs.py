"""Outputs of a motion: the coordinate of each, and its rates, by the names of quantities."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import Measure
from compoundkin.kinematics.extremes.stretches import driver_pace
from compoundkin.kinematics.quantities import owner_of, quantity
from compoundkin.model.attributes import (
    ANGLE,
    CATALOGUE,
    DISPLACEMENT,
    LENGTH,
    PARTS,
    POSITION,
    TABULATED,
    Kind,
    coordinate_dimension,
    derivative_order,
    motion_figure,
    unit_of,
)
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism

# Number of outputs of a mechanism that names none.
MOST_OUTPUTS = 6


@dataclass(frozen=True)
class Output:
    """An output: a point that moves in the plane, or a coordinate of a link, pair, driver or point.

    `coordinate`, `rate` and `second` are names of real quantities; a point that moves in the plane has no coordinate,
    and its rates are lengths of vectors. Derived quantities, such as a transmission angle, have no rates.
    """

    name: str
    kind: Kind
    owner: str
    coordinate: str
    rate: str = ""
    second: str = ""

    @property
    def is_point(self) -> bool:
        """Whether it is a point that moves in the plane."""
        return not self.coordinate

    @property
    def names(self) -> tuple[str, ...]:
        """The names of its quantities."""
        return tuple(name for name in (self.coordinate, self.rate, self.second) if name)

    def measures(self, motion: Motion) -> tuple[str | Measure, ...]:
        """Return its quantities as measures along a motion, without a search by name each time."""
        if not self.rate or (self.kind == "points" and self.coordinate):
            return self.names
        is_angle = self.kind == "links" or (self.kind != "points" and getattr(motion, self.kind)[self.owner].is_angle)
        dimension, is_length = coordinate_dimension(is_angle), not is_angle
        scales = [(motion.sizes if is_length else 1.0) * driver_pace(motion) ** k for k in range(3)]
        return tuple(
            Measure(name, unit_of(motion.mechanism.unit, dimension, k), k, partial(self._values, k=k),
                    self.is_point, scales[k], dimension)
            for k, name in enumerate((self.coordinate, self.rate, self.second)) if name
        )  # fmt: skip

    def _values(self, motion: Motion, k: int) -> Number:
        owner = getattr(motion, self.kind)[self.owner]
        if self.kind == "links":
            return getattr(owner, TABULATED[self.kind][k])
        values = owner.derivative(k)
        return np.abs(np.asarray(values)) if self.is_point else values


def outputs_of(motion: Motion, names: Sequence[str]) -> tuple[Output, ...]:
    """Return the outputs of names of quantities, each once. Raises UnknownName with the nearest known name.

    >>> import compoundkin as ck
    >>> motion = ck.solve(ck.load("six-bar"))
    >>> [(one.name, one.coordinate, one.rate) for one in outputs_of(motion, ["G.velocity", "rocker"])]
    [('G', '', 'G.velocity.length'), ('rocker.angle', 'rocker.angle', 'rocker.angular_velocity')]
    """
    # a figure of the whole motion stands for its quantity
    found = (_output(motion, motion_figure(name)[0]) for name in names)
    return tuple({one.name: one for one in found}.values())


def _output(motion: Motion, name: str) -> Output:
    for owner, word, part in _readings(name):
        for kind in CATALOGUE:
            if owner in getattr(motion, kind):
                known = owner_of(motion, kind, owner).attributes
                is_part = kind == "points" and part in PARTS
                if (not word or word in known) and (is_part or not part):
                    return _of(motion, kind, owner, word or next(iter(known)), part)
    return _derived(motion, name)


def _derived(motion: Motion, name: str) -> Output:
    """Return a derived quantity of an owner as an output, a vector by its length."""
    found = quantity(motion, name)
    owner, kind = next(
        (owner, kind)
        for owner, word, _ in _readings(name)
        for kind in CATALOGUE
        if owner in getattr(motion, kind) and owner_of(motion, kind, owner).has(word)
    )
    return Output(name, kind, owner, f"{name}.{LENGTH}" if found.is_vector else name)


def _readings(name: str) -> list[tuple[str, str, str]]:
    """Return the readings of a name as owner, word and part of a vector, the last two optional."""
    head, _, last = name.rpartition(".")
    front, _, middle = head.rpartition(".")
    return [(name, "", ""), (head, last, ""), (front, middle, last)]


def _of(motion: Motion, kind: Kind, owner: str, word: str, part: str) -> Output:
    words = TABULATED[kind]
    if kind != "points":
        known = owner_of(motion, kind, owner).attributes
        first = word if known[word].order == 0 else words[0]
        return Output(f"{owner}.{first}", kind, owner, *(f"{owner}.{one}" for one in (first, *words[1:3])))
    axis = word if word in PARTS else part if word == words[0] and part in PARTS and part != LENGTH else ""
    if axis:
        return Output(f"{owner}.{axis}", kind, owner, f"{owner}.{axis}", *(f"{owner}.{w}.{axis}" for w in words[1:3]))
    return Output(owner, kind, owner, "", *(f"{owner}.{one}.{LENGTH}" for one in words[1:3]))


def default_outputs(mechanism: Mechanism) -> tuple[str, ...]:
    """Return the outputs that a mechanism names, else a few tracer points and links without a driver.

    >>> from compoundkin.model.elements import drive, link
    >>> crank = link("crank", A=0, B=1), link("rod", B=0, P=2), link("frame", A=0)
    >>> default_outputs(Mechanism("m", *crank, drive("crank")))
    ('P.position', 'rod.angle')
    """
    if mechanism.outputs:
        return mechanism.outputs
    used = {letter for pair in mechanism.written_pairs for letter in pair.letters}
    free = {k: links for k, links in mechanism.carriers.items() if k not in used and len(links) == 1}
    driven = {drive.link for drive in mechanism.drives} | mechanism.auxiliary_links
    tracers = [letter for letter, links in free.items() if links != (FRAME,)]
    tracers = [letter for letter in tracers if free[letter][0] not in driven] or tracers
    sliding = {pair.members[1]: pair.name for pair in mechanism.written_pairs
               if pair.is_simple and not pair.free_is_angle and pair.members[0] == FRAME}  # fmt: skip
    moving = [name for name in mechanism.links if name != FRAME and name not in driven]
    lines = [f"{sliding[name]}.{DISPLACEMENT}" if name in sliding else f"{name}.{ANGLE}" for name in moving]
    return tuple([*(f"{name}.{POSITION}" for name in tracers), *lines][:MOST_OUTPUTS])


def chosen_outputs(motion: Motion, outputs: Sequence[str] = ()) -> tuple[str, ...]:
    """Return the given outputs, else the default ones within the order of the motion."""
    return tuple(outputs) or tuple(n for n in default_outputs(motion.mechanism) if derivative_order(n) <= motion.order)
