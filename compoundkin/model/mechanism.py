"""A mechanism: links, pairs and drivers, checked as a whole when it is made."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from functools import cached_property
from typing import Any, cast

from compoundkin.base.arguments import checked
from compoundkin.base.display import ShowsPicture, counted
from compoundkin.base.errors import InvalidInput, InvalidMechanism, Problem, UnknownName, nearest
from compoundkin.base.nested_values import same
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Number
from compoundkin.model.drawn_poses import told_poses
from compoundkin.model.elements import FRAME, Drawn, Expectation, Item, Lead, Link, Mode
from compoundkin.model.geometry import Geometry, fitted_pose, read_off, real
from compoundkin.model.load_problems import load_problems, load_warnings
from compoundkin.model.number_problems import places_wanted
from compoundkin.model.outlines.outline_problems import crossed_polygons, outline_problems
from compoundkin.model.pairs.profile_contact import as_profiled
from compoundkin.model.pin_pairs import NamesOfPairs
from compoundkin.model.units import given_units
from compoundkin.model.validation import problems_of
from compoundkin.model.written import Written

# What is written of a mechanism beside its items.
_ABOUT = ("title", "source", "description", "outputs", "time", "unit", "units")


class Mechanism(Written, ShowsPicture):
    """Links, pairs and drivers, written with the words of this module. Checked as a whole when it is made.

    Two links that have a point of the same name are pinned there; the link called "frame" is the frame.
    `time` holds the times (seconds) at which it is solved unless a call says otherwise.
    Equality compares what is written, array by array.

    Raises InvalidMechanism, listing every problem with its place.

    >>> from compoundkin.model.elements import drive, link
    >>> four_bar = Mechanism(
    ...     "Four-bar",
    ...     link("frame", A=(0, 0), D=(4, 0)),
    ...     link("crank", A=(0, 0), B=(1, 0)),
    ...     link("coupler", B=(0, 0), C=(3, 0)),
    ...     link("rocker", D=(0, 0), C=(3, 0)),
    ...     drive("crank"),
    ... )
    >>> four_bar.pins["B"]
    ('crank', 'coupler')
    """

    @checked
    def __init__(
        self,
        title: str,
        *items: Item,
        unit: str = "",
        source: str = "",
        description: str = "",
        outputs: str | Sequence[str] = (),
        time: Any = None,
        units: Any = None,
    ) -> None:
        self.title = title
        self.units, problems = given_units(units, unit)
        self.unit = self.units.length if self.units else unit
        self.source = source
        self.description = description
        self.outputs: tuple[str, ...] = (outputs,) if isinstance(outputs, str) else tuple(outputs)
        self.time: Number | None = real("time", time)
        self.items: tuple[Item, ...] = items
        problems += problems_of(self)
        problems += load_problems(self, self.names, units is not None) + outline_problems(self, self.names)
        problems += [] if problems else self._misfits()
        if problems:
            raise InvalidMechanism(problems, heading=f"{title!r} cannot be built")
        load_warnings(self)

    def _misfits(self) -> Iterator[Problem]:
        """Find dimensions of pairs that do not fit, where nothing else is wrong and all points have places."""
        for where, pair in self.placed_pairs if not self.unplaced else ():
            yield from pair.misfits(self.geometry, where)
        yield from crossed_polygons(self) if not self.unplaced else ()

    @cached_property
    def geometry(self) -> Geometry:
        """The dimensions as numbers, those of links given as drawn read off the drawing.

        Raises InvalidInput where points have neither coordinates nor a place in the drawing.
        """
        if self.unplaced:
            raise InvalidInput(places_wanted(self.unplaced), heading=f"{self.title!r} has no dimensions yet")
        points: dict[str, Mapping[str, Number]] = {}
        poses: dict[str, Pose] = {}
        fixed = self.links[FRAME].points
        seen = {**{k: p for k, p in fixed.items() if p is not None}, **self.sketch}
        for name, item in self.links.items():
            if name == FRAME:
                poses[name] = FIXED
                points[name] = {k: self.sketch[k] if p is None else p for k, p in item.points.items()}
            elif item.is_drawn:
                pose, points[name] = read_off(item.letters, self.sketch)
                if pose is not None:
                    poses[name] = pose
            else:
                points[name] = {k: p for k, p in item.points.items() if p is not None}
                pose = fitted_pose(points[name], seen) if self.sketch else None
                if pose is not None:
                    poses[name] = pose
        return Geometry(points, poses, frozenset(n for n, i in self.links.items() if i.is_drawn), seen, self._profiles)

    @cached_property
    def drawn_poses(self) -> Mapping[str, Pose]:
        """The poses of links that the drawing shows. A pair may tell the angle of a link of one point.

        >>> from compoundkin.model.elements import drawn, link
        >>> from compoundkin.model.pairs import slide
        >>> guide, way = link("frame", A=0), slide("block", on="frame", through="A", angle=0.5)
        >>> Mechanism("m", guide, link("block", B=0), way, drawn(A=0, B=1)).drawn_poses["block"].angle.c[0].round(6)
        np.float64(0.5)
        """
        geometry = self.geometry
        if not self.sketch or len(geometry.drawn) == len(self.links):
            return geometry.drawn
        ends = [(pair, pair.ends(geometry)) for pair in self.written_pairs]
        return told_poses(geometry.points, ends, geometry.sketch, geometry.drawn)

    @property
    def _profiles(self) -> float:
        """The size of the largest profile."""
        return max((own.extent for pair in self.written_pairs if (own := as_profiled(pair))), default=0.0)

    @cached_property
    def names(self) -> NamesOfPairs:
        """The links, points and pairs that loads may name."""
        return NamesOfPairs(self)

    def replace(self, *items: Item, **changes: Any) -> Mechanism:
        """Return a copy with items in the place of those of their names.

        A word with no counterpart is added; `title`, `unit`, `source`, `description`, `outputs`, `time` by keyword.

        >>> from compoundkin.model.elements import drive, link
        >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=1), drive("crank"))
        >>> crank.replace(link("crank", A=0, B=2)).links["crank"].points["B"]
        (2+0j)
        """
        keys = {_identity(item): item for item in items}
        kept = [keys.pop(_identity(item), item) for item in self.items]
        words = {**{k: getattr(self, k) for k in _ABOUT[1:-2]}, **({} if "units" in changes else self.unit_words)}
        title = changes.pop("title", self.title)
        return Mechanism(title, *kept, *keys.values(), **{**words, **changes})

    def without_leads(self) -> Mechanism:
        """Return the mechanism itself, without what leads its points and turns its links."""
        gone = (Lead, Expectation)
        return Mechanism(self.title, *(item for item in self.items if not isinstance(item, gone)), **self.unit_words)

    @property
    def unit_words(self) -> dict[str, Any]:
        """What is said of its units where another mechanism is made of it."""
        return {"unit": self.unit} if self.units is None else {"units": self.units}

    def link(self, name: str) -> Link:
        """Return the link of a name; raises UnknownName."""
        if name not in self.links:
            raise UnknownName(Problem(name, "there is no such link", nearest(name, list(self.links))))
        return self.links[name]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Mechanism) and same(_plain(self), _plain(other))

    def __getstate__(self) -> dict[str, Any]:
        # what is written; what was found of it since is found again
        return {name: getattr(self, name) for name in (*_ABOUT, "items")}

    def __hash__(self) -> int:
        return hash((self.title, tuple(self.links)))

    @property
    def in_numbers(self) -> str:
        """How many links and cylinders it is written with, in words."""
        cylinders = f" and {counted(len(self.cylinders), 'cylinder')}" if self.cylinders else ""
        return f"{counted(len(self.rigid_links), 'link')}{cylinders}"

    def __repr__(self) -> str:
        return f"Mechanism({self.title!r}: {self.in_numbers}, {counted(len(self.drives), 'driver')})"


def _identity(item: Item) -> tuple[Any, ...]:
    if isinstance(item, Mode):
        return Mode, frozenset(item.links)
    if isinstance(item, Drawn):
        return (Drawn,)
    return type(item), (item.quantity, item.at) if isinstance(item, Expectation) else item.name


def _plain(mechanism: Mechanism) -> list[Any]:
    """Return what is written, as nested builtins and arrays, for comparison."""
    about = [getattr(mechanism, k) for k in _ABOUT]
    drawing = [["Drawn", mechanism.sketch]] if mechanism.sketch else []
    written = [
        [
            getattr(item, "table", "") or type(item).__name__,
            {field.name: getattr(item, field.name) for field in fields(cast("Any", item))},
        ]
        for item in mechanism.items
        if not isinstance(item, Drawn)
    ]
    # the order between different words says nothing; that within one kind does
    return [*about, *drawing, *sorted(written, key=lambda entry: str(entry[0]))]
