"""What a mechanism file holds: the tables of keys that reader, writer and schema follow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from compoundkin.model.attributes import IMBALANCE, TIME_RATIO, is_angle_word, motion_figure
from compoundkin.model.definition import CYLINDERS, DRIVES
from compoundkin.model.elements import Drive
from compoundkin.model.fields import Key
from compoundkin.model.loads import WRITTEN as LOADS
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.outlines import OUTLINES, LinkOutline
from compoundkin.model.pairs import KINDS
from compoundkin.model.pairs import WRITTEN as PAIRS
from compoundkin.model.pairs.cylinder import Cylinder

FORMATS = (1,)


@dataclass(frozen=True)
class TableForm:
    """Tables of one sort in a mechanism file. ``[name.X]`` if named, ``[[name]]`` if an array of tables."""

    name: str
    form: Literal["named", "array"]
    keys: tuple[Key, ...]
    doc: str
    required: bool = False


FORMAT_DOC = f"The version of this file format; known: {', '.join(map(str, FORMATS))}."

HEAD = (
    Key("title", "text", "What the mechanism is called.", required=True),
    Key("unit", "text", "The unit of every length, such as mm; it is only ever printed.", default=""),
    Key("units", "units", "The units of length, mass and force, in place of unit, where there are masses or forces."),
    Key("source", "text", "Where the mechanism comes from: book, page, paper.", default=""),
    Key("description", "text", "What it is and what to look at.", default=""),
    Key("outputs", "names", 'The quantities a report tabulates, such as "bar.angle".', default=()),
    Key("time", "times", "The times in seconds at which drivers with laws are solved unless others are asked for."),
)

LINK = (
    Key(
        "points",
        "points",
        "The points of the link in its own frame by letter, or the letters alone for a link given as drawn.",
        required=True,
    ),
)

DRAWN = Key("drawn", "drawing", "Points as drawn: one pose in global coordinates, exact or roughly.")

GRAVITY = Key("gravity", "point", "The acceleration of free fall, in m/s^2 whatever the unit of length.")

MODE = (
    Key("links", "names", "Links of the group whose assembly mode is chosen.", required=True),
    Key("sign", "sign", "The assembly mode, 1 or -1, as the group's kind defines it.", required=True),
)

EXPECTED = (
    Key("at", "at", 'Driver values; rates by "DRIVER.speed" or "DRIVER.acceleration"; or the time.', default=()),
    Key("quantity", "name", 'What is expected, such as "G.velocity".', required=True),
    Key("value", "published", "The published value; degrees where the quantity is an angle.", required=True),
    Key("tolerance", "margin", "How far the solved value may be from it, in the same unit.", required=True),
)

# In the order in which a file is written; the drawing comes after the drives.
TABLES = ("links", *PAIRS, CYLINDERS, DRIVES, *LOADS, OUTLINES, "modes", "expected")


def table_forms() -> tuple[TableForm, ...]:
    """Return the forms of all tables, in their order."""
    return (
        TableForm("links", "named", LINK, "The links by name; the one called frame is fixed.", required=True),
        *(TableForm(name, "array", kind.keys, f"Each is a {kind.title}.") for name, kind in PAIRS.items()),
        TableForm(CYLINDERS, "array", Cylinder.keys, "Each is a cylinder: a barrel and a rod between two pins."),
        TableForm(DRIVES, "array", Drive.keys, "The drivers of pairs, and the prescribed motions of points and links."),
        *(TableForm(name, "array", kind.keys, f"Each is a {kind.title}.") for name, kind in LOADS.items()),
        TableForm(OUTLINES, "array", LinkOutline.keys, "Each is an outline of a link, or a part of it."),
        TableForm("modes", "array", MODE, "Assembly modes chosen by sign instead of by a drawing."),
        TableForm("expected", "array", EXPECTED, "Published numbers to hold the solution against."),
    )


# The pins are not written: they follow from shared letters.
_PIN_IS_ANGLE = next(kind.free_is_angle for kind in KINDS.values() if not kind.table)

KIND = "kind"
# The law whose segments need not say how far they rise.
DWELL = "dwell"
# It is told what repeats by the cam.
PROGRAM = (
    Key("segments", "turned", "Its dwells, rises and falls over a full turn, one after another.", required=True),
    Key("start", "coordinate", "The lift at its beginning.", default=0.0),
)


def is_angle(mechanism: Mechanism, drive: Drive) -> bool | None:
    """Return whether a driver's coordinate is an angle (else a length). None where its pair is not determined.

    >>> from compoundkin.model.elements import link
    >>> m = Mechanism("m", link("frame", A=0), link("crank", A=0, B=1))
    >>> is_angle(m, Drive("crank", "crank"))
    True
    """
    choices = mechanism.drivable(drive)
    if len(choices) != 1:
        return None
    written = {pair.name: pair.free_is_angle for pair in mechanism.written_pairs}
    return written.get(choices[0], _PIN_IS_ANGLE)


def name_is_angle(mechanism: Mechanism, name: str) -> bool | None:
    """Return whether the coordinate that a name means is an angle. None where it means none."""
    pair = mechanism.names.coordinate(name)
    return None if pair is None else pair.free_is_angle


def quantity_is_angle(quantity: object) -> bool:
    """Return whether a quantity is written in degrees in files.

    >>> quantity_is_angle("bar.angle"), quantity_is_angle("bar.angular_velocity")
    (True, False)
    """
    if not isinstance(quantity, str):
        return False
    of, figure = motion_figure(quantity)
    if figure in (TIME_RATIO, IMBALANCE):
        return figure == IMBALANCE
    return "." in of and is_angle_word(of.rpartition(".")[2])
