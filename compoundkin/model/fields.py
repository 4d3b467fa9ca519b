"""Keys of a mechanism file, declared with the fields they describe; readers, writers and schema follow.

A kind of pair declares each of its fields once: as a field of a dataclass, with `value_key`, `link_key` or `point_key`
as its metadata. The argument of its constructor, the key in files, the schema and the checks of names follow.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping, MutableMapping
from dataclasses import MISSING, Field, dataclass, fields
from importlib import import_module
from typing import Any, Literal, ParamSpec, TypeVar

from compoundkin.base.arguments import checked
from compoundkin.base.errors import Problem, suggestion

# The kinds of values: their form in a file and their type in Python.
#   name     text                                         str
#   text     text                                         str
#   names    list of texts                                tuple of str
#   length   number or nested list of numbers             float or array
#   angle    the same in degrees, or {rad = ...}          float or array, radians
#   point    [x, y], {polar = [radius, degrees]}          complex or array
#   sign     1 or -1                                      int
#   flag     true or false                                bool
#   two      list of two numbers or lists of numbers      tuple of two floats or arrays
#   points   table of points by letter, or list of letters   mapping of letter to complex, array or None
#   drawing  table of points by letter                    mapping of letter to complex or array
#   whole    whole number                                 int
#   span     positive number; degrees where it is of a rotation   float
#   times    list of seconds or {from, to, step}          array
#   segments list of tables, as ProgramSegment has keys          tuple of ProgramSegment
#   law      table with a kind, and the keys of that law  law
#   units    table of the units of length, mass, force   the same
#   spot     name of a point, or a point in the link's frame   str, complex or array
#   spots    list of such                                 tuple of str, complex or array
#   layers   whole number, or a list of them              tuple of int
#   amount   number or nested list, {over, at, values}    float, array or LoadTable
#   planar   the same of a vector: a point, or a list of two amounts   complex, array or tuple of two
#   number   a single number                              float
#   turn     a single angle in degrees, or {rad = ...}    float, radians
#   place    [x, y], {polar = [radius, degrees]}, single  complex
#   places   list of such points                          tuple of complex
#   route    the same, two or more                        tuple of complex
#   path     table with a kind, and the keys of that path  Path
#   turned   list of segments over degrees                tuple of ProgramSegment over radians
#   program  such a list, or a table of it and a start    Program over radians
#   profile  table with a kind, and the keys of that profile   Profile
#   reach    [from, to], each a length or a letter, or {from, to} of which one may be left out   tuple of two
#   sweep    the same of angles in degrees                tuple of two, radians
# Of a driven coordinate, an angle (degrees in files) or a length, as its pair has it:
#   values   number or nested list, {from, to, step}, {rad = ...}   float or array
#   coordinate  number or nested list, {rad = ...}        float or array
#   rate     number or nested list, {rpm = ...}, {deg = ...}        float or array
#   at       table of such numbers by driver, rates by "driver.speed"   tuple of (key, float)
# Of a published quantity, an angle (degrees in files) or anything else, as its name says:
#   published  number or [x, y]                           complex
#   margin   number                                       float
Kind = Literal[
    "name", "text", "names", "length", "angle", "point", "sign", "flag", "two", "points", "drawing",
    "values", "rate", "at", "published", "margin",
    "whole", "span", "times", "coordinate", "segments", "law",
    "units", "spot", "spots", "layers", "amount", "planar",
    "number", "turn", "place", "places", "route", "path", "turned", "program", "profile", "reach", "sweep",
]  # fmt: skip


class Item:
    """What a mechanism is written with: links, pairs, drivers, loads, outlines and what is said of them."""

    __slots__ = ()


Named = TypeVar("Named")


class LateKinds(MutableMapping[str, Named]):
    """Kinds by a name, each written as "file.Class" of a folder; its file is imported when it is first asked for.

    Who goes through the values imports all of them; the names alone import nothing. A class may be set like any value.

    >>> kinds = LateKinds[type[Any]]("compoundkin.model.pairs", {"arcs": "arc.ArcSlot"})
    >>> kinds["arcs"].title
    'pin-in-arc pair'
    """

    def __init__(self, folder: str, places: Mapping[str, str]) -> None:
        self._folder = folder
        self._known: dict[str, str | Named] = {**places}

    def __getitem__(self, name: str) -> Named:
        kind = self._known[name]
        if isinstance(kind, str):
            file, _, word = kind.partition(".")
            kind = self._known[name] = getattr(import_module(f"{self._folder}.{file}"), word)
        return kind

    def __setitem__(self, name: str, kind: Named) -> None:
        self._known[name] = kind

    def __delitem__(self, name: str) -> None:
        del self._known[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._known)

    def __len__(self) -> int:
        return len(self._known)


@dataclass(frozen=True)
class Key:
    """One key of a table in a mechanism file. It has its name, what it holds, its default, and a sentence on it."""

    name: str
    kind: Kind
    doc: str
    required: bool = False
    default: Any = None


def value_key(kind: Kind, doc: str) -> dict[str, Any]:
    """Return the metadata of a field that is a key in files."""
    return {"kind": kind, "doc": doc}


def link_key(doc: str) -> dict[str, Any]:
    """Return the metadata of a field that names a link."""
    return {"kind": "name", "doc": doc, "is_link": True}


def point_key(link: str, doc: str) -> dict[str, Any]:
    """Return the metadata of a field that names a point of a link. The field `link` names the link.

    Where the field may be empty, the only point of the link is meant.
    """
    return {"kind": "name", "doc": doc, "link": link}


def spot_key(link: str, doc: str) -> dict[str, Any]:
    """Return the metadata of a field for a point or place."""
    return {"kind": "spot", "doc": doc, "link": link}


def declared_keys(kind: type[Any]) -> tuple[Key, ...]:
    """Return the keys in files of a kind, by its fields.

    >>> from compoundkin.model.pairs.slot import Slot
    >>> [key.name for key in declared_keys(Slot) if key.required]
    ['link', 'on', 'through']
    """
    return tuple(_key(kind, field) for field in fields(kind) if "kind" in field.metadata)


def _key(kind: type[Any], field: Field[Any]) -> Key:
    doc = field.metadata["doc"].format(called="/".join(link_fields(kind)[:2]).upper())
    required = field.default is MISSING
    return Key(field.name, field.metadata["kind"], doc, required, None if required else field.default)


class DeclaredKeys:
    """The keys of a kind as an attribute of its class."""

    def __init__(self) -> None:
        self._known: dict[str, tuple[Key, ...]] = {}

    def __get__(self, item: object, kind: type[Any]) -> tuple[Key, ...]:
        name = f"{kind.__module__}.{kind.__qualname__}"
        if name not in self._known:
            self._known[name] = declared_keys(kind)
        return self._known[name]


def link_fields(kind: type[Any]) -> tuple[str, ...]:
    """Return the fields that name links."""
    return tuple(field.name for field in fields(kind) if "is_link" in field.metadata)


def point_fields(kind: type[Any]) -> Mapping[str, str]:
    """Return the fields that name points, with those that name their links. Those that may be empty come first."""
    points = [field for field in fields(kind) if "link" in field.metadata]
    return {field.name: field.metadata["link"] for field in sorted(points, key=lambda field: field.default != "")}


@dataclass(frozen=True)
class NameWording:
    """The words with which a kind reports problems of its names."""

    verb: str = "run"
    two_links: str = "name two links"
    point: str = "the one that is meant"


def name_problems(
    item: Any, links: Mapping[str, tuple[str, ...]], where: str, wording: NameWording
) -> Iterator[Problem]:
    """Find unknown links, one link twice, and points that a link lacks."""
    members = {field: getattr(item, field) for field in link_fields(type(item))}
    missing = [(field, name) for field, name in members.items() if name not in links]
    for field, name in missing:
        yield Problem(f"{where}.{field}", f"there is no link {name!r}", suggestion(name, list(links)))
    if missing:
        return
    if len(set(members.values())) < len(members):
        field, name = list(members.items())[-1]
        yield Problem(f"{where}.{field}", f"{name!r} cannot {wording.verb} on itself", wording.two_links)
    for field, link in point_fields(type(item)).items():
        letter, name = getattr(item, field), members[link]
        if not isinstance(letter, str):
            continue
        if letter == "":
            choice = f"name {wording.point}: {', '.join(links[name])}"
            yield Problem(f"{where}.{field}", f"link {name!r} has several points", choice)
        elif letter not in links[name]:
            remedy = suggestion(letter, list(links[name]))
            yield Problem(f"{where}.{field}", f"link {name!r} has no point {letter!r}", remedy)


def implied_points(item: Any, links: Mapping[str, tuple[str, ...]]) -> dict[str, str]:
    """Return the points that are left out because they are the only ones of their links."""
    found = {}
    for field, link in point_fields(type(item)).items():
        points = links.get(getattr(item, link), ())
        given = getattr(item, field)
        if isinstance(given, str) and given == "" and len(points) == 1:
            found[field] = points[0]
    return found


P = ParamSpec("P")
Constructed = TypeVar("Constructed")


def constructor(name: str, kind: Callable[P, Constructed]) -> Callable[P, Constructed]:
    """Return the function with which users write a kind. Its fields are the arguments, their texts the docstring.

    >>> from compoundkin.model.pairs.slot import Slot
    >>> constructor("slot", Slot)("crank", on="arm", at="B", through="C").name
    'crank/arm'
    """

    assert isinstance(kind, type)
    signature = inspect.signature(kind).replace(return_annotation=kind.__name__)
    make: Callable[P, Constructed] = kind

    def made(*args: P.args, **kwargs: P.kwargs) -> Constructed:
        try:
            signature.bind(*args, **kwargs)
        except TypeError as error:
            # name the function, not the class
            raise TypeError(f"{name}(): {error}") from None
        return make(*args, **kwargs)

    text = inspect.cleandoc(kind.__doc__ or "").partition("\n\n>>>")
    arguments = "\n".join(f"* `{key.name}`: {key.doc}{_UNITS.get(key.kind, '')}" for key in declared_keys(kind))
    made.__doc__ = f"{text[0]}\n\n{arguments}{''.join(text[1:])}"
    made.__name__, made.__qualname__, made.__module__ = name, name, kind.__module__
    made.__signature__ = signature  # type: ignore[attr-defined]
    return checked(made)


# Units that the text of a field leaves out, for users of Python.
_UNITS: Mapping[Kind, str] = {"angle": " In radians; a number or an array."}
# Kinds of keys that are one real number, or two; arrays of them for several designs.
_ONE, _TWO = ("length", "angle", "number", "turn", "coordinate", "rate", "span"), ("two", "reach", "sweep")


def stated_numbers(item: Any) -> dict[str, Any]:
    """Return the numbers of an item by name: "offset", or "radii.0" of two.

    >>> from compoundkin.model.pairs.gear import gear
    >>> sorted(stated_numbers(gear("sun", "planet", carrier="arm", teeth=(20, 40))))
    ['pressure_angle', 'teeth.0', 'teeth.1']
    """
    found: dict[str, Any] = {}
    for key in item.keys:
        value = getattr(item, key.name)
        if key.kind in _ONE:
            found[key.name] = value
        elif key.kind in _TWO and value is not None:
            found |= {f"{key.name}.{index}": one for index, one in enumerate(value)}
    return {name: value for name, value in found.items() if value is not None and not isinstance(value, str)}


def changed_fields(item: Any, numbers: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields of an item that these numbers change, named as by `stated_numbers`.

    >>> from compoundkin.model.pairs.gear import gear
    >>> changed_fields(gear("sun", "planet", carrier="arm", teeth=(20, 40)), {"teeth.1": 30})
    {'teeth': (20.0, 30)}
    """
    found: dict[str, Any] = {}
    for name, value in numbers.items():
        field, _, index = name.partition(".")
        if index:
            two = found.get(field, getattr(item, field))
            found[field] = (value, two[1]) if index == "0" else (two[0], value)
        else:
            found[field] = value
    return found
