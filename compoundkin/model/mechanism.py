"""`Mechanism`: links, pairs and drivers, validated as a whole; poses from its drawing; one design of several."""

from __future__ import annotations

import warnings
from collections import deque
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import fields, is_dataclass, replace
from functools import cached_property
from math import prod
from typing import Any, cast

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.copies import nested_equal
from compoundkin.base.display import DisplaysPicture, count_phrase
from compoundkin.base.errors import ExplainsAttributes, InvalidInput, InvalidMechanism, Problem, UnknownName, suggestion
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import constant
from compoundkin.model.attributes import CATALOGUE, DERIVED
from compoundkin.model.definition import MechanismDefinition, MechanismNames
from compoundkin.model.elements import Drawn, Drive, Expectation, Link, Mode
from compoundkin.model.fields import Item
from compoundkin.model.geometry import FRAME, Geometry, link_from_drawing, pose_from_points, real
from compoundkin.model.load_validation import load_problems, load_warnings
from compoundkin.model.outline_validation import crossed_polygons, outline_problems
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import DrawnPair, Ends, as_orienting, as_turn_counting, misfit_problems
from compoundkin.model.prescribed_motion import PrescribedMotion
from compoundkin.model.units import checked_units
from compoundkin.model.validation import definition_problems, missing_places

# The attributes of a mechanism beside its items.
_ABOUT = ("title", "source", "description", "outputs", "time", "unit", "units")


class Mechanism(MechanismDefinition, DisplaysPicture, ExplainsAttributes):
    """Links, pairs and drivers, validated as a whole on construction.

    Two links that have a point of the same name are pinned there; the link called "frame" is the frame.
    `time` holds the times (seconds) at which it is solved by default.
    Equality compares all elements, array by array.

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
        self.units, problems = checked_units(units, unit)
        self.unit = self.units.length if self.units else unit
        self.source = source
        self.description = description
        self.outputs: tuple[str, ...] = (outputs,) if isinstance(outputs, str) else tuple(outputs)
        self.time: Number | None = real("time", time)
        self.items: tuple[Item, ...] = items
        self._validate(problems)
        load_warnings(self)

    def _validate(self, problems: Sequence[Problem] = (), must_fit: bool = True) -> None:
        """Raise InvalidMechanism for all problems of its elements, those that are known first."""
        # units with problems are not missing
        has_units = self.units is not None or bool(problems)
        found = [*problems, *definition_problems(self), *load_problems(self, self.names, has_units)]
        found += outline_problems(self, self.names)
        found += [] if found else self._misfits(must_fit)
        if found:
            raise InvalidMechanism(found, heading=f"{self.title!r} cannot be built")

    def _misfits(self, must_fit: bool) -> Iterator[Problem]:
        """Find dimensions of pairs that do not fit, where nothing else is wrong and all points have places."""
        for where, pair in self.placed_pairs if not self.unplaced else ():
            problems = list(pair.misfits(self.geometry, where))
            yield from problems
            if must_fit and not problems:
                yield from misfit_problems(pair.fits(self.geometry), where)
        yield from crossed_polygons(self) if not self.unplaced else ()

    @cached_property
    def geometry(self) -> Geometry:
        """The dimensions as numbers, those of links given as drawn read off the drawing.

        Raises InvalidInput where points have neither coordinates nor a place in the drawing.
        """
        if self.unplaced:
            raise InvalidInput(missing_places(self.unplaced), heading=f"{self.title!r} has no dimensions yet")
        points: dict[str, Mapping[str, Number]] = {}
        poses: dict[str, Pose] = {}
        fixed = self.links[FRAME].points
        sketch = {**{k: p for k, p in fixed.items() if p is not None}, **self.sketch}
        for name, item in self.links.items():
            if name == FRAME:
                poses[name] = FIXED
                points[name] = {k: self.sketch[k] if p is None else p for k, p in item.points.items()}
            elif item.is_drawn:
                pose, points[name] = link_from_drawing(item.letters, self.sketch)
                if pose is not None:
                    poses[name] = pose
            else:
                points[name] = {k: p for k, p in item.points.items() if p is not None}
                pose = pose_from_points(points[name], sketch) if self.sketch else None
                if pose is not None:
                    poses[name] = pose
        as_drawn = frozenset(name for name, item in self.links.items() if item.is_drawn)
        return Geometry(points, poses, as_drawn, sketch, self._profiles)

    @cached_property
    def drawn_poses(self) -> Mapping[str, Pose]:
        """The poses of links in the drawing. The angle of a link of one point may follow from a pair.

        >>> from compoundkin.model.elements import drawn, link
        >>> from compoundkin.model.pairs.prismatic import slide
        >>> guide, way = link("frame", A=0), slide("block", on="frame", through="A", angle=0.5)
        >>> Mechanism("m", guide, link("block", B=0), way, drawn(A=0, B=1)).drawn_poses["block"].angle.c[0].round(6)
        np.float64(0.5)
        """
        geometry = self.geometry
        if not self.sketch or len(geometry.drawn) == len(self.links):
            return geometry.drawn
        ends = [(pair, pair.ends(geometry)) for pair in self.written_pairs]
        return poses_from_drawing(geometry.points, ends, geometry.sketch, geometry.drawn)

    @property
    def _profiles(self) -> float:
        """The size of the largest profile."""
        return max((pair.extent for pair in self.written_pairs), default=0.0)

    @cached_property
    def names(self) -> MechanismNames:
        """The links, points and pairs that loads may name."""
        return MechanismNames(self)

    def replace(self, *items: Item, without: str | Sequence[str] = (), **changes: Any) -> Mechanism:
        """Return a copy in which items replace those of the same name.

        An item without a counterpart is added; `title`, `unit`, `source`, `description`, `outputs`, `time` by keyword.
        What `without` names is taken out first, as by the method of that name; the whole is validated once, so that a
        pin is swapped for a slide in one call. Raises InvalidMechanism, and UnknownName for what there is not.

        >>> from compoundkin.model.elements import drive, link
        >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=1), drive("crank"))
        >>> crank.replace(link("crank", A=0, B=2)).links["crank"].points["B"]
        (2+0j)
        >>> from compoundkin.model.pairs.prismatic import slide
        >>> guided = crank.replace(slide("crank", on="frame", through="O"), link("frame", O=0), without="crank.A")
        >>> sorted(guided.pins), [pair.name for pair in guided.written_pairs]
        ([], ['crank/frame'])
        """
        for name in [str(item) for item in items if isinstance(item, str)]:
            remedy = _points_of(self, name) or "write what takes its place"
            what = "a name is no part of a mechanism; what is taken out is said by without="
            raise InvalidMechanism(Problem(name, what, remedy))
        if without:
            names = (without,) if isinstance(without, str) else tuple(without)
            kept = copy(self)
            for cached in [name for name in vars(kept) if name not in (*_ABOUT, "items")]:
                del kept.__dict__[cached]
            kept.items = _items_without(self, names)
            kept.outputs = _outputs_of(kept.items, self)
            return kept.replace(*items, **changes)
        words = {**{k: getattr(self, k) for k in _ABOUT[1:-2]}, **({} if "units" in changes else self.unit_words)}
        title = changes.pop("title", self.title)
        return Mechanism(title, *self._replaced(items), **{**words, **changes})

    def without(self, *names: str) -> Mechanism:
        """Return a copy without links, pairs, drivers, loads of these names, or points: "rocker.C" is C of the rocker.

        With a link goes all that is written of it: pairs, drivers, masses, loads, outlines, modes, and the outputs and
        published numbers that name it. Raises UnknownName for what there is not, InvalidMechanism where what is left is
        no mechanism.

        >>> from compoundkin.model.elements import drive, link
        >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=1), link("rod", B=0, C=3), drive("crank"))
        >>> list(crank.without("rod").links)
        ['frame', 'crank']
        >>> crank.without("rot")
        Traceback (most recent call last):
        compoundkin.base.errors.UnknownName: rot: there is nothing of this name; did you mean 'rod'?
        """
        return self.replace(without=names)

    def as_design(self, *items: Item) -> Mechanism:
        """Return a copy as `replace` does, as one of several designs: if its wheels do not fit it is not assembled."""
        design = copy(self)
        design.items = self._replaced(items)
        design._validate(must_fit=False)
        return design

    def _replaced(self, items: Sequence[Item]) -> tuple[Item, ...]:
        keys = {_identity(item): item for item in items}
        return *(keys.pop(_identity(item), item) for item in self.items), *keys.values()

    def without_prescribed_motion(self) -> Mechanism:
        """Return the mechanism without prescribed motions and expectations."""
        removed = (PrescribedMotion, Expectation)
        return Mechanism(self.title, *(item for item in self.items if not isinstance(item, removed)), **self.unit_words)

    @property
    def unit_words(self) -> dict[str, Any]:
        """The keywords of its units, to construct a variant of it."""
        return {"unit": self.unit} if self.units is None else {"units": self.units}

    def link(self, name: str) -> Link:
        """Return the link of a name; raises UnknownName."""
        if name not in self.links:
            raise UnknownName(Problem(name, "there is no such link", suggestion(name, list(self.links))))
        return self.links[name]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Mechanism) and nested_equal(_plain(self), _plain(other))

    def __getstate__(self) -> dict[str, Any]:
        # the definition without cached properties
        return {name: getattr(self, name) for name in (*_ABOUT, "items")}

    def __hash__(self) -> int:
        return hash((self.title, tuple(self.links)))

    @property
    def in_numbers(self) -> str:
        """The numbers of its links and cylinders, in words."""
        cylinders = f" and {count_phrase(len(self.cylinders), 'cylinder')}" if self.cylinders else ""
        return f"{count_phrase(len(self.rigid_links), 'link')}{cylinders}"

    def __repr__(self) -> str:
        return f"Mechanism({self.title!r}: {self.in_numbers}, {count_phrase(len(self.drives), 'driver')})"


def _items_without(mechanism: Mechanism, names: Sequence[str]) -> tuple[Item, ...]:
    """Return the items that are left where some are taken out by name. Raises UnknownName."""
    named = {getattr(item, "name", "") for item in mechanism.items if not isinstance(item, Mode | Drawn)}
    letters = {f"{link}.{letter}" for link, own in mechanism.links.items() for letter in own.points}
    unknown = [name for name in names if name not in named | letters]
    if unknown:
        known = sorted(filter(None, named)) + sorted(letters)
        raise UnknownName(
            [
                Problem(n, "there is nothing of this name", _points_of(mechanism, n) or suggestion(str(n), known))
                for n in unknown
            ]
        )
    gone = set(names)
    left: list[Item] = []
    for item in mechanism.items:
        if getattr(item, "name", None) in gone or gone & _links_of(item):
            continue
        if isinstance(item, Drive) and item.pair in gone:
            continue
        if isinstance(item, Link):
            points = {letter: p for letter, p in item.points.items() if f"{item.name}.{letter}" not in gone}
            item = replace(item, points=points) if len(points) < len(item.points) else item
        left.append(item)
    letters_left = {letter for item in left if isinstance(item, Link) for letter in item.points}
    drawn = ({k: p for k, p in item.points.items() if k in letters_left} for item in left if isinstance(item, Drawn))
    places = next(drawn, {})
    left = [item for item in left if not isinstance(item, Drawn)] + ([Drawn(places)] if places else [])
    owners = {getattr(item, "name", "") for item in left} | letters_left
    return tuple(item for item in left if not isinstance(item, Expectation) or _owners_of(item) <= owners)


def _points_of(mechanism: Mechanism, letter: str) -> str:
    """Return the remedy for the letter of a pin, which links have by their points; nothing for any other name."""
    owners = [f"{link}.{letter}" for link in mechanism.carriers.get(letter, ())]
    return f"{letter} is a point of links: {' or '.join(owners)}" if owners else ""


def _links_of(item: Item) -> set[str]:
    """The links that an item joins or acts on."""
    if isinstance(item, Link):
        return set()
    several = (*getattr(item, "members", ()), *getattr(item, "links", ()))
    return {*several, *(getattr(item, word, "") for word in ("link", "on"))} - {""}


def _owners_of(expected: Expectation) -> set[str]:
    """What a published number names: the owner of its quantity, and drivers."""
    return {name.partition(".")[0] for name in (expected.quantity, *(key for key, _ in expected.at))}


def _outputs_of(items: Sequence[Item], mechanism: Mechanism) -> tuple[str, ...]:
    """Return the outputs of a mechanism that name something among these items."""
    links = [item for item in items if isinstance(item, Link)]
    owners = {getattr(item, "name", "") for item in items} | {letter for link in links for letter in link.points}
    return tuple(name for name in mechanism.outputs if "(" in name or name.partition(".")[0] in owners)


def _identity(item: Item) -> tuple[Any, ...]:
    if isinstance(item, Mode):
        return Mode, frozenset(item.links)
    if isinstance(item, Drawn):
        return (Drawn,)
    return type(item), (item.quantity, item.at) if isinstance(item, Expectation) else getattr(item, "name", "")


def _plain(mechanism: Mechanism) -> list[Any]:
    """Return the definition as nested builtins and arrays, for comparison."""
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
    # the order of elements matters within one kind only
    return [*about, *drawing, *sorted(written, key=lambda entry: str(entry[0]))]


Points = Mapping[str, Mapping[str, Number]]


def poses_from_drawing(
    points: Points, pairs: Iterable[tuple[Pair, Ends]], sketch: Mapping[str, Number], known: Mapping[str, Pose]
) -> dict[str, Pose]:
    """Find poses of links from where letters are drawn and poses that are known.

    `points` are those of the links in their own frames. A link of two drawn letters has its pose from them; one of a
    single letter has its angle from a slide, a gear or a wheel that rolls, where the other members' poses are known.
    Both continue from link to link; a link whose pose does not follow is left out.
    """
    propagation = _PosePropagation(points, sketch, known)
    # pairs that count turns come last: the angle from a slide does not depend on turns
    for pair, ends in sorted(pairs, key=lambda entry: as_turn_counting(entry[0]) is not None):
        for link in pair.members:
            propagation.pairs[link].append((pair, ends))
    return propagation.poses_of_all()


class _PosePropagation:
    """Known poses and points of the drawing, from which further poses follow."""

    def __init__(self, points: Points, sketch: Mapping[str, Number], known: Mapping[str, Pose]) -> None:
        self.points, self.places, self.poses = points, dict(sketch), dict(known)
        self.pairs: dict[str, list[tuple[Pair, Ends]]] = {link: [] for link in points}
        self.carriers: dict[str, list[str]] = {}
        for link, letters in points.items():
            for letter in letters:
                self.carriers.setdefault(letter, []).append(link)
        for link in known:
            self._see(link)

    def poses_of_all(self) -> dict[str, Pose]:
        """Return the poses of all links that follow from the drawing."""
        waiting = deque(link for link in self.points if link not in self.poses)
        while waiting:
            link = waiting.popleft()
            pose = None if link in self.poses else self._pose(link)
            if pose is not None:
                self.poses[link] = pose
                waiting.extend(other for other in self._concerned(link) if other not in self.poses)
        return self.poses

    def _see(self, link: str) -> None:
        for letter, point in self.points[link].items():
            if letter not in self.places:
                self.places[letter] = self.poses[link].at(point).c[0]

    def _concerned(self, link: str) -> Iterator[str]:
        """Add the places of a link's letters, and yield the links that may follow now."""
        new = [letter for letter in self.points[link] if letter not in self.places]
        self._see(link)
        for letter in new:
            yield from self.carriers[letter]
        for pair, _ in self.pairs[link]:
            yield from pair.members

    def _pose(self, link: str) -> Pose | None:
        points = self.points[link]
        drawn = next((letter for letter in points if letter in self.places), None)
        if drawn is None:
            return None
        pose = pose_from_points(points, self.places)
        if pose is not None:
            return pose
        for pair, ends in self.pairs[link]:
            orienting = as_orienting(pair)
            seen = DrawnPair(ends, tuple(self.poses.get(name) for name in pair.members), self.places)
            angle = orienting.drawn_angle(seen, pair.members.index(link)) if orienting else None
            if angle is not None:
                u = np.cos(angle) + 1j * np.sin(angle)
                counted = constant(angle) if as_turn_counting(pair) else None
                return Pose(constant(self.places[drawn] - u * points[drawn]), constant(u), counted)
        return None


def values_of_design(value: Any, shape: tuple[int, ...], design: int) -> Any:
    """Return one design's values of a number, an array, or a table of them.

    Arrays broadcast with a motion's shape; those of one axis are the same for all designs.

    >>> values_of_design(np.array([[1.0], [2.0]]), (2, 73), 1), values_of_design(3.0, (2, 73), 1)
    (2.0, 3.0)
    """
    if isinstance(value, np.ndarray):
        return _row_of_design(value, shape, design) if value.ndim > 1 else value
    if isinstance(value, Mapping):
        return {key: values_of_design(one, shape, design) for key, one in value.items()}
    if type(value) is tuple:
        return tuple(values_of_design(one, shape, design) for one in value)
    return value


def mechanism_of_design(mechanism: Mechanism, shape: tuple[int, ...], design: int) -> Mechanism:
    """Return the mechanism of one of several designs, which were validated together. The shape is that of its motion.

    >>> from compoundkin.model.elements import drive, link
    >>> lengths = np.array([[1.0], [2.0]])
    >>> cranks = Mechanism("m", link("frame", A=0), link("crank", A=0, B=lengths), drive("crank"))
    >>> mechanism_of_design(cranks, (2, 73), 1).links["crank"].points["B"]
    (2+0j)
    """
    with warnings.catch_warnings():
        # warnings were given for the whole
        warnings.simplefilter("ignore")
        own = copy(mechanism)
        own.items = tuple(_item_of_design(item, shape, design) for item in mechanism.items)
        own.time = values_of_design(mechanism.time, shape, design)
    return own


def _item_of_design(item: Any, shape: tuple[int, ...], design: int) -> Any:
    """Return an item with the numbers of one design; itself where all designs share them."""
    if not is_dataclass(item) or isinstance(item, type):
        return item
    values = {field.name: getattr(item, field.name) for field in fields(item) if field.init}
    own = {name: values_of_design(value, shape, design) for name, value in values.items()}
    changed = {name: value for name, value in own.items() if value is not values[name]}
    return replace(item, **changed) if changed else item


def _row_of_design(value: Number, shape: tuple[int, ...], design: int) -> Number:
    last = value.shape[-1]
    row = np.broadcast_to(value, (*shape[:-1], last)).reshape(prod(shape[:-1]), last)[design]
    return row.item() if last == 1 else row


_OTHER_ATTRIBUTES = {word for kind in ("points", "links", "pairs") for word in (*CATALOGUE[kind], *DERIVED[kind])}
# Attributes of drivers alone, such as their efforts.
DRIVER_ATTRIBUTES = frozenset({*CATALOGUE["drives"], *DERIVED["drives"]} - _OTHER_ATTRIBUTES)


def available_outputs(mechanism: Mechanism, drivers: Collection[str]) -> list[str]:
    """Return the outputs that exist with these drivers.

    Efforts and powers of links that no longer drive are left out.
    """
    known = {*mechanism.carriers, *mechanism.links, *(pair.name for pair in mechanism.written_pairs)}
    return [name for name in mechanism.outputs if _is_available(name, known, drivers)]


def _is_available(name: str, known: Collection[str], drivers: Collection[str]) -> bool:
    owner, words = name.split("(")[0].split(".")[0], name.rpartition(")")[2].split(".")[1:]
    return owner in drivers or (owner in known and not DRIVER_ATTRIBUTES & set(words))
