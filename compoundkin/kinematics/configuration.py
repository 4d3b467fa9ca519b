"""One configuration of a mechanism: where all its links are; and how configurations are called."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

from compoundkin.base.display import Shows
from compoundkin.base.errors import InvalidInput, Problem, nearest
from compoundkin.base.poses import Pose
from compoundkin.kinematics.groups.steps import Step
from compoundkin.kinematics.solving_order import Plan
from compoundkin.structure.kinematic_structure import Structure

BETWEEN = " / "
# The configuration of a mechanism of which every group has one.
ONLY = "only one"
# How the modes of a group with signs are written; zero at its limit position, where both are one.
SIGNS = {1: "+", -1: "-", 0: "±"}


@dataclass(frozen=True, eq=False)
class Configuration(Shows):
    """A mechanism assembled at one value of every driver (radians or lengths), in one way.

    `poses` are those of all links. `modes[k]` is, for groups with several configurations, "+", "-" ("±" at the limit
    position) or the number. `margins[k]` tells for groups with signs how far the limit position is (a squared sine).
    """

    structure: Structure
    values: Mapping[str, float]
    poses: Mapping[str, Pose]
    modes: Mapping[int, str]
    margins: Mapping[int, float]
    dimensions: Mapping[str, Mapping[str, complex]]

    @cached_property
    def name(self) -> str:
        """What it is called: the groups with more than one configuration, each with its sign or number."""
        return named(self.structure, self.modes)

    @cached_property
    def points(self) -> Mapping[str, complex]:
        """Where every point is."""
        placed = (
            (letter, self.poses[link].at(p).c[0]) for link, ps in self.dimensions.items() for letter, p in ps.items()
        )
        return {letter: complex(place) for letter, place in placed}

    @cached_property
    def angles(self) -> Mapping[str, float]:
        """The angle of every link, radians, between -pi and pi."""
        return {link: float(pose.u.angle().c[0]) for link, pose in self.poses.items()}

    def __repr__(self) -> str:
        return f"Configuration({self.name!r} at {', '.join(f'{k} = {v:.6g}' for k, v in self.values.items())})"


def label(structure: Structure, k: int) -> str:
    """What group `k` is called in a configuration's name: its kind and its first link."""
    group = structure.groups[k]
    return f"{group.name}({group.links[0]})"


def named(structure: Structure, modes: Mapping[int, str]) -> str:
    """The name of a configuration: signs as RRR(coupler)+, numbers as RRR-RRR(plate) 3."""
    parts = (f"{label(structure, k)}{' ' if mode.isdecimal() else ''}{mode}" for k, mode in sorted(modes.items()))
    return BETWEEN.join(parts) or ONLY


def read_name(plan: Plan, name: str) -> dict[int, int]:
    """The signs and numbers that a name gives to groups; raises InvalidInput for parts that name none."""
    return dict(_read(plan, part.strip()) for part in name.split(BETWEEN.strip())) if name.strip() != ONLY else {}


def _read(plan: Plan, part: str) -> tuple[int, int]:
    known = dict(_labels(plan))
    for text, k in known.items():
        mode = _mode(plan.steps[k], part.removeprefix(text)) if part.startswith(text) else None
        if mode is not None:
            return k, mode
    what = f"{part!r} is no configuration of a group"
    raise InvalidInput(Problem("modes", what, nearest(part, list(known)) + " with +, - or a number from 1"))


def _labels(plan: Plan) -> Iterator[tuple[str, int]]:
    for k, step in enumerate(plan.steps):
        if step.modes != 1:
            yield label(plan.structure, k), k


def _mode(step: Step, text: str) -> int | None:
    if step.modes == 0:
        return int(text) if text.strip().isdecimal() and int(text) > 0 else None
    return {"+": 1, "-": -1}.get(text)
