"""Kinds of pair that answer what has no default, and nothing else; and mechanisms with them."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, field
from typing import ClassVar

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.poses import End
from compoundkin.base.series import Series
from compoundkin.files import document
from compoundkin.model.fields import link_key, point_key
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs import WRITTEN
from compoundkin.model.pairs.contract import Ends, Pair, Poses
from compoundkin.model.pairs.symbols import Mark, Stud
from compoundkin.structure import assur_groups


@dataclass(frozen=True, eq=False)
class Level(Pair):
    """The link `link` may shift on the link `on`, but not turn."""

    link: str = field(metadata=link_key("The link that may shift."))
    _: KW_ONLY
    on: str = field(metadata=link_key("The link on which it does."))
    at: str = field(default="", metadata=point_key("link", "Its point."))
    through: str = field(metadata=point_key("on", "The point from which displacements count."))

    code: ClassVar[str] = "T"
    title: ClassVar[str] = "level pair"
    held: ClassVar[int] = 1
    free: ClassVar[tuple[str, ...]] = ("displacement", "offset")
    free_is_angle: ClassVar[bool] = False
    table: ClassVar[str] = "levels"

    @property
    def members(self) -> tuple[str, ...]:
        return self.on, self.link

    @property
    def letters(self) -> tuple[str, ...]:
        return self.at, self.through

    def ends(self, geometry: Geometry) -> Ends:
        return End(geometry.points[self.on][self.through], 1 + 0j), End(geometry.points[self.link][self.at], 1 + 0j)

    def closure(self, ends: Ends, poses: Poses) -> tuple[Series, ...]:
        first, second = (pose.carry(end) for pose, end in zip(poses, ends, strict=True))
        return (first.along.cross(second.along),)

    def coordinate(self, ends: Ends, poses: Poses) -> Series:
        first, second = (pose.carry(end) for pose, end in zip(poses, ends, strict=True))
        return first.along.dot(second.point - first.point)

    def generic(self, rng: np.random.Generator) -> Ends:
        along = complex(np.exp(1j * rng.uniform(0.0, 2.0 * np.pi)))
        return tuple(End(complex(*rng.standard_normal(2)), along) for _ in range(2))

    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        return Stud(0, ends[0].point), Stud(1, ends[1].point)


@dataclass(frozen=True, eq=False)
class Guided(Level):
    """The link `link` shifts along the x axis of the link `on` and does not turn: a slide that nothing can drive."""

    code: ClassVar[str] = "U"
    title: ClassVar[str] = "guided pair"
    held: ClassVar[int] = 2
    free: ClassVar[tuple[str, ...]] = ("displacement",)
    table: ClassVar[str] = "guideds"

    def closure(self, ends: Ends, poses: Poses) -> tuple[Series, ...]:
        first, second = (pose.carry(end) for pose, end in zip(poses, ends, strict=True))
        return first.along.cross(second.point - first.point), first.along.cross(second.along)

    def generic(self, rng: np.random.Generator) -> Ends:
        along, start = complex(np.exp(1j * rng.uniform(0.0, 2.0 * np.pi))), complex(*rng.standard_normal(2))
        return End(start, along), End(start + along * rng.standard_normal(), along)


def register(kind: type[Pair], monkeypatch: pytest.MonkeyPatch) -> None:
    """Take a kind up among the others, as its line in the registry does, while a test runs."""
    monkeypatch.setitem(assur_groups._RANK, kind.code, assur_groups._RANK.get(kind.code, len(assur_groups._RANK)))
    if kind.table:
        monkeypatch.setitem(WRITTEN, kind.table, kind)
        first, *others = (name for name in document.TABLES if name != kind.table)
        monkeypatch.setattr(document, "TABLES", (first, kind.table, *others))


def with_level() -> ck.Mechanism:
    """A tray on a crank, kept level."""
    return ck.Mechanism(
        "Level tray",
        ck.link("frame", A=(0, 0)),
        ck.link("crank", A=(0, 0), B=(30, 0)),
        ck.link("tray", B=(0, 0), C=(50, 10)),
        Level("tray", on="frame", at="B", through="A"),
        ck.drive("crank", values=ck.deg([10, 50, 200])),
        ck.drawn(A=(0, 0), B=(29, 5), C=(79, 15)),
        outputs=["C.velocity", "tray.angle"],
    )


def with_guided() -> ck.Mechanism:
    """A slider-crank whose piston is guided."""
    return ck.Mechanism(
        "Guided piston",
        ck.link("frame", O=(0, 0)),
        ck.link("crank", O=(0, 0), A=(40, 0)),
        ck.link("rod", A=(0, 0), B=(120, 0), C=(60, 20)),
        ck.link("piston", B=(0, 0), D=(20, 10)),
        Guided("piston", on="frame", at="B", through="O"),
        ck.drive("crank", values=ck.deg([10, 50, 200])),
        ck.drawn(O=(0, 0), A=(39, 7), B=(159, 0), C=(100, 20), D=(179, 10)),
        outputs=["D.velocity"],
    )
