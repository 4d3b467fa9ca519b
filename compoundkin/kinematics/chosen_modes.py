"""What a call and a mechanism say of assembly modes: signs and numbers by link or by name, hints and drawings."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem, suggestion
from compoundkin.base.poses import Pose
from compoundkin.kinematics.configuration import BETWEEN, ONLY, Configuration, label
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.geometry import vector

# What chose an assembly mode, in words.
CHOSEN_BY = {
    "sign": "chosen by sign",
    "drawing": "nearest to the drawing",
    "hint": "nearest to the hint",
    "default": "taken by default",
    "redundant": "in which the redundant pairs close",
    "number": "chosen by number",
    "configuration": "that of the configuration given",
    "only one": "the only one",
}


@dataclass(frozen=True)
class GroupMode:
    """The assembly mode of a group in a motion, and what chose it.

    `sign` is that at the first pose, +1 or -1, an array of them for several designs, None where a group has one mode
    or its modes have no sign.
    """

    links: tuple[str, ...]
    sign: int | Number | None
    chosen: str

    def __repr__(self) -> str:
        signs = np.unique(self.sign) if self.sign is not None else ()
        told = " or ".join(f"{int(sign):+d}" for sign in signs)
        return f"GroupMode({', '.join(self.links[:2])}: {f'{told}, ' if told else ''}{self.chosen})"


def modes_of(
    solving_order: SolvingOrder,
    chosen_by: Mapping[int, str],
    sign: Callable[[int, Number, Number], Number],
    shape: tuple[int, ...],
) -> dict[str, GroupMode]:
    """Return the mode of every group by its name in configurations. Designs are in a shape."""
    rows = np.arange(int(np.prod(shape)))[:, None]
    found = {}
    for solver in solving_order.solvers:
        signs = None
        if solver.modes == 2:
            each = np.broadcast_to(sign(solver.index, rows, np.zeros((1, 1))), rows.shape)
            signs = each.astype(int).reshape(shape)[()]
        chosen = CHOSEN_BY.get(chosen_by.get(solver.index, ""), "found")
        found[label(solving_order.structure, solver.index)] = GroupMode(solver.group.links, signs, chosen)
    return found


def signs_of(
    solving_order: SolvingOrder, modes: Mapping[str, int] | str | Configuration | None = None
) -> dict[int, int]:
    """Return the modes chosen by sign, by group. Those of the call go before those of the mechanism."""
    mechanism = solving_order.structure.mechanism
    if isinstance(modes, Configuration):
        return {}
    if isinstance(modes, str):
        written = {link: mode.sign for mode in mechanism.modes for link in mode.links}
        return {**_by_group(solving_order, written), **read_name(solving_order, modes)}
    called, written = dict(modes or {}), {link: mode.sign for mode in mechanism.modes for link in mode.links}
    return {**_by_group(solving_order, written), **_by_group(solving_order, called)}


def _by_group(solving_order: SolvingOrder, modes: Mapping[str, int]) -> dict[int, int]:
    signs: dict[int, int] = {}
    where = {link: solver.index for solver in solving_order.solvers for link in solver.group.links}
    for name, sign in modes.items():
        solving_order.structure.mechanism.link(name)
        if name not in where:
            raise InvalidInput(Problem(f"modes.{name}", "this link is driven or fixed: it has no assembly mode"))
        if sign not in (1, -1) and not (
            solving_order.solvers[where[name]].is_numbered and isinstance(sign, int) and sign > 0
        ):
            raise InvalidInput(Problem(f"modes.{name}", f"an assembly mode is +1 or -1, not {sign!r}"))
        if signs.setdefault(where[name], sign) != sign:
            raise InvalidInput(Problem(f"modes.{name}", "another link of its group has the opposite mode"))
    return signs


def read_name(solving_order: SolvingOrder, name: str) -> dict[int, int]:
    """Return the signs and numbers that a name gives to groups. Raises InvalidInput for parts that name none."""
    return (
        dict(_read(solving_order, part.strip()) for part in name.split(BETWEEN.strip())) if name.strip() != ONLY else {}
    )


def _read(solving_order: SolvingOrder, part: str) -> tuple[int, int]:
    known = dict(_labels(solving_order))
    for text, k in known.items():
        mode = _mode(solving_order.solvers[k], part.removeprefix(text)) if part.startswith(text) else None
        if mode is not None:
            return k, mode
    what = f"{part!r} is no configuration of a group"
    raise InvalidInput(Problem("modes", what, suggestion(part, list(known)) + " with +, - or a number from 1"))


def _labels(solving_order: SolvingOrder) -> Iterator[tuple[str, int]]:
    for solver in solving_order.solvers:
        if solver.modes != 1:
            yield label(solving_order.structure, solver.index), solver.index


def _mode(solver: GroupSolver, text: str) -> int | None:
    if solver.is_numbered:
        return int(text) if text.strip().isdecimal() and int(text) > 0 else None
    return {"+": 1, "-": -1}.get(text)


@dataclass(frozen=True)
class Shown:
    """Where a mechanism is shown, to which the nearest mode is chosen.

    `source` is what shows it: `configuration`, `hint` or `drawing`. The drivers' values at which it is shown are read
    off the `poses` of links, else off the points `beside` them.
    """

    source: str
    points: Mapping[str, Number]
    poses: Mapping[str, Pose]
    beside: Mapping[str, Number]


def shown_by(
    solving_order: SolvingOrder,
    modes: Mapping[str, int] | str | Configuration | None = None,
    hint: Mapping[str, object] | None = None,
) -> Shown:
    """Return where a call shows the mechanism, else its drawing. A name of modes is one at the motion's first pose.

    Raises InvalidInput for a configuration of another mechanism, and for hints that do not fit.
    """
    mechanism, relaxation = solving_order.structure.mechanism, solving_order.structure.relaxation
    if isinstance(modes, Configuration) and list(modes.structure.mechanism.links) != list(mechanism.links):
        raise InvalidInput(Problem("modes", "the configuration is one of another mechanism"))
    hinted = read_hint(solving_order, hint)
    if isinstance(modes, Configuration):
        return Shown("configuration", modes.points, modes.poses, modes.points)
    if hinted:
        return Shown("hint", hinted, {}, {})
    points = {**(relaxation.places if relaxation else {}), **mechanism.sketch}
    if isinstance(modes, str):
        return Shown("drawing", points, {}, {})
    poses = relaxation.poses if relaxation and not mechanism.sketch else mechanism.drawn_poses
    return Shown("drawing", points, poses, mechanism.geometry.sketch)


def read_hint(solving_order: SolvingOrder, hint: Mapping[str, object] | None) -> dict[str, Number]:
    """Return a hint as planar vectors. Raises InvalidInput for points that the mechanism does not have."""
    letters = solving_order.structure.mechanism.carriers
    wrong = [
        Problem(f"hint.{k}", f"there is no point {k!r}", suggestion(k, list(letters)))
        for k in hint or {}
        if k not in letters
    ]
    if wrong:
        raise InvalidInput(wrong)
    found = {k: vector(f"hint.{k}", v) for k, v in (hint or {}).items()}
    if not all(np.isfinite(v).all() for v in found.values()):
        raise InvalidInput(Problem("hint", "a point of the hint is not finite"))
    return found
