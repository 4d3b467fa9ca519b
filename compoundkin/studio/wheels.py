"""Edits of wheels and cams: gears, belts, racks, and profiles for a rise and a return, each from a small form.

A wheel is a link that turns at a point: one that is drawn there, or a link of that point alone.
"""

from __future__ import annotations

import cmath
from collections.abc import Mapping
from itertools import accumulate
from math import degrees
from typing import Any

from compoundkin.base.errors import Problem, UnknownName
from compoundkin.model.fields import declared_keys
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs import WRITTEN
from compoundkin.studio.edited_document import (
    DIGITS,
    Edit,
    EditedDocument,
    called,
    direction_of,
    positive_in,
    refused,
    word_in,
)

# What is called so where nothing else has the name.
WHEEL, CAM = "wheel", "cam"
# The radii of profiles that are changed in the text, and what they are.
RADII = {"radius": "radius of the disc", "base": "base circle"}
TEETH = "teeth"
# The motion for which a profile is made, by its pieces: what is changed of it is its lift.
PROGRAM = "program"
# A follower of a cam dwells in the turn that its rise and its return leave.
TURN = 360.0


def _wheel_at(sheet: EditedDocument, letter: str, word: str, link: Any, carrier: str) -> str:
    """Return the link that turns at a point: the one that is named, one that is a wheel there, or a new wheel."""
    if isinstance(link, str) and link:
        if link not in sheet.carriers(letter):
            raise refused(f"{link} has no point {letter}", "name a link that turns there")
        return link
    for name in sheet.carriers(letter):
        if name not in (FRAME, carrier) and len(sheet.points(name)) == 1 and not sheet.is_block(name):
            return name
    name = sheet.new_name(word)
    sheet.links[name] = {"points": [letter] if sheet.is_as_drawn else {letter: [0, 0]}}
    return name


def _wheels(sheet: EditedDocument, edit: Edit, array: str) -> dict[str, Any]:
    """Return the table of two wheels at two points of one link: on links that turn there, or wheels of their own."""
    one, two = word_in(edit, "point"), word_in(edit, "with")
    if one == two:
        raise refused("two wheels have two axes", "choose two points")
    both = [name for name in sheet.carriers(one) if name in sheet.carriers(two)]
    if not both:
        raise refused(f"no link carries both {one} and {two}", "ground both, or choose two points of one bar")
    first = _wheel_at(sheet, one, WHEEL, edit.get("first"), both[0])
    second = _wheel_at(sheet, two, WHEEL, edit.get("second"), both[0])
    for name, _, other in sheet.tables():
        if name == array and {other.get("first"), other.get("second")} == {first, second}:
            raise refused(f"{first} and {second} are joined so already", "delete that pair first")
    return {"first": first, "second": second} | ({} if both[0] == FRAME else {"carrier": both[0]})


def gear(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Put two gears at two points of one link, by their teeth."""
    teeth = edit.get("teeth")
    if not (isinstance(teeth, list) and len(teeth) == 2 and all(isinstance(n, int) and 0 < n < 1e6 for n in teeth)):
        raise refused(f"{teeth!r} are no numbers of teeth", "give two whole numbers")
    table = _wheels(sheet, edit, "gears") | {"teeth": teeth}
    if edit.get("internal"):
        if teeth[0] >= teeth[1]:
            raise refused("a ring has more teeth than the gear in it", "choose the gear first, and more teeth second")
        table["internal"] = True
    sheet.document.setdefault("gears", []).append(table)
    return {"link": table["first"]}


def belt(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Lead a belt around two pulleys at two points of one link, by their radii; open or crossed."""
    radii = edit.get("radii")
    if not (isinstance(radii, list) and len(radii) == 2):
        raise refused(f"{radii!r} are no radii", "give two")
    sizes = [positive_in({"radii": one}, "radii") for one in radii]
    if not all(sizes):
        raise refused("a pulley has a radius", "give two numbers above 0")
    table = _wheels(sheet, edit, "belts") | {"radii": [sheet.number(one) for one in sizes]}
    apart = abs(sheet.place(word_in(edit, "point")) - sheet.place(word_in(edit, "with")))
    least = sum(sizes) if edit.get("crossed") else abs(sizes[0] - sizes[1])
    if apart <= least:
        raise refused("the pulleys lie in each other", f"the axes are {sheet.number(apart)} apart")
    sheet.document.setdefault("belts", []).append(table | ({"crossed": True} if edit.get("crossed") else {}))
    return {"link": table["first"]}


def rack(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Let a pinion at a fixed point roll on what slides at another: the rack's pitch line is that of its guide."""
    axis, letter = word_in(edit, "point"), word_in(edit, "with")
    if FRAME not in sheet.carriers(axis):
        raise refused(f"{axis} is not fixed", "ground it first (key G)")
    rack = next((name for name in sheet.carriers(letter) if name != FRAME and sheet.is_block(name)), None)
    slide = next((t for name, _, t in sheet.tables() if name == "slides" and t.get("link") == rack), None)
    if rack is None or slide is None or slide.get("on", FRAME) != FRAME:
        raise refused(f"{letter} does not slide on the frame", "let it slide first (key S)")
    along = direction_of(sheet, slide)
    away = ((sheet.place(axis) - sheet.place(letter)) * along.conjugate()).imag
    if abs(away) <= 1e-9 * sheet.drawing.size:
        raise refused(f"{axis} is on the guide of {letter}", "a pinion has a radius: move one of them")
    angle = degrees(cmath.phase(along / sheet.drawing.poses.get(rack, (0j, 1 + 0j))[1]))
    pinion = _wheel_at(sheet, axis, WHEEL, edit.get("pinion"), FRAME)
    table: dict[str, Any] = {"rack": rack, "pinion": pinion, "at": axis, "through": letter}
    table |= {"radius": sheet.number(abs(away))} | ({"side": -1} if away < 0 else {})
    table |= {"angle": sheet.number(angle)} if round(angle, DIGITS) else {}
    sheet.document.setdefault("racks", []).append(table)
    return {"link": pinion}


def cam_pair(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Put a cam at a fixed point that leads another point: a disc, or the profile for a rise and a return."""
    axis, letter = word_in(edit, "point"), word_in(edit, "with")
    if FRAME not in sheet.carriers(axis):
        raise refused(f"{axis} is not fixed", "ground it first (key G)")
    centre, place = sheet.place(axis), sheet.place(letter)
    numbers = {k: positive_in(edit, k) for k in ("radius", "roller")}
    gap = abs(place - centre)
    if gap <= 1e-9 * sheet.drawing.size:
        raise refused(f"{letter} is at {axis}", "choose a point away from it")
    follower = next((n for n in sheet.carriers(letter) if n != FRAME and sheet.is_block(n)), "")
    follower = follower or next((n for n in sheet.carriers(letter) if n != FRAME), "")
    if not follower:
        raise refused(f"{letter} is on the frame", "choose a point that slides or swings")
    cam = _wheel_at(sheet, axis, CAM, None, FRAME)
    table: dict[str, Any] = {"link": follower, "on": cam, "at": letter}
    if numbers["roller"]:
        table["radius"] = sheet.number(numbers["roller"])
    if edit.get("kind") == "disc":
        eccentric = positive_in(edit, "rise") / 2
        table["profile"] = {"kind": "disc", "radius": sheet.number(numbers["radius"]),
                            "middle": [sheet.number(eccentric), 0]}  # fmt: skip
    else:
        table["profile"] = _made_profile(sheet, edit, (axis, letter, follower), numbers)
    sheet.document.setdefault("cams", []).append(table)
    return {"link": cam}


def _made_profile(
    sheet: EditedDocument, edit: Edit, at: tuple[str, str, str], numbers: Mapping[str, float]
) -> dict[str, Any]:
    """Return the profile for a motion: a rise, a dwell, the return, a dwell; of a slide, or of a bar that swings."""
    axis, letter, follower = at
    rise, over, dwell, back = (positive_in(edit, key) for key in ("rise", "over", "dwell", "back"))
    rest = TURN - over - dwell - back
    if min(rise, over, back) <= 0 or rest < 0:
        raise refused("rise, dwell and return are no part of a turn", f"together at most {TURN:g} degrees")
    parts = [(over, rise), (dwell, 0.0), (back, -rise), (rest, 0.0)]
    number = sheet.number
    program = [
        {"law": "cycloidal", "over": number(long), "rise": number(by)} if by else {"law": "dwell", "over": number(long)}
        for long, by in parts
        if long
    ]
    made = {"kind": "made", "program": program, "base": number(numbers["radius"])}
    made |= {"follower": "roller", "roller": number(numbers["roller"])} if numbers["roller"] else {}
    slide = next((t for name, _, t in sheet.tables() if name == "slides" and t.get("link") == follower), None)
    if slide is not None:
        return made | _sliding_follower(sheet, sheet.place(axis), sheet.place(letter), slide)
    return made | _swinging_follower(sheet, sheet.place(axis), letter, follower)


def _sliding_follower(
    sheet: EditedDocument, centre: complex, place: complex, slide: Mapping[str, Any]
) -> dict[str, Any]:
    """Return how a follower that slides lies to the cam's centre. Raises InvalidInput where a cam cannot lead it."""
    if slide.get("on", FRAME) != FRAME:
        raise refused(f"{slide['link']} does not slide on the frame", "choose another point")
    along = direction_of(sheet, slide)
    # a guide beside the axis is one beside the cam's middle
    away = ((sheet.place(slide["through"]) - centre) * along.conjugate()).imag
    if ((place - centre) * along.conjugate()).real < 0:
        raise refused("it slides toward the cam", "turn the slide by 180 degrees")
    return {"angle": round(degrees(cmath.phase(along)), DIGITS) + 0.0, "offset": sheet.number(away)}


def _swinging_follower(sheet: EditedDocument, centre: complex, letter: str, follower: str) -> dict[str, Any]:
    """Return how a follower that swings lies to the cam's centre. Raises InvalidInput where it has no fixed pivot."""
    pivot = next((k for k in sheet.points(follower) if k != letter and sheet.is_fixed(k)), None)
    if pivot is None:
        raise refused(f"{follower} neither slides on the frame nor turns about a fixed point", "ground its end")
    place = sheet.place(letter)
    arm, to = place - sheet.place(pivot), sheet.place(pivot) - centre
    side = 1 if ((place - centre) * arm.conjugate()).imag >= 0 else -1
    return {"pivot": sheet.pair(to), "arm": sheet.number(abs(arm)), "side": side}


def numbers_in_text(array: str, table: Mapping[str, Any]) -> dict[tuple[str, int | str], str]:
    """Return the numbers of a pair's table that are changed in the text, by key and place there: what each is."""
    found: dict[tuple[str, int | str], str] = {}
    for key in declared_keys(WRITTEN[array]) if array in WRITTEN else ():
        value = table.get(key.name)
        if key.name == TEETH and isinstance(value, list):
            found |= {(key.name, k): f"teeth of {table.get(end)}" for k, end in enumerate(("first", "second"))}
        elif key.kind == "profile" and isinstance(value, dict):
            found |= {(key.name, part): told for part, told in RADII.items()
                      if isinstance(value.get(part), int | float)}  # fmt: skip
            if lift_of(value.get(PROGRAM)):
                found[key.name, PROGRAM] = "lift"
    return found


def lift_of(program: Any) -> float:
    """Return how far the follower of a motion program goes from its lowest to its highest; 0 for what is none.

    >>> lift_of([{"law": "cycloidal", "over": 90, "rise": 30}, {"law": "dwell", "over": 90}, {"rise": -20}])
    30.0
    """
    rises = [one.get("rise", 0.0) for one in program if isinstance(one, dict)] if isinstance(program, list) else []
    if not all(isinstance(one, int | float) for one in rises):
        return 0.0
    places: list[float] = [0.0, *accumulate(rises)]
    return float(max(places) - min(places))


def _scale_program(program: list[dict[str, Any]], lift: float) -> None:
    """Give a motion program another lift, all its rises in the same ratio: it ends where it ended."""
    ratio = lift / lift_of(program)
    for one in program:
        if one.get("rise"):
            one["rise"] = float(f"{one['rise'] * ratio:.12g}")


def stated_number(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Give a number of a pair another value, where it is written: teeth, the radius of a profile, the lift of a law."""
    name, entry, value = word_in(edit, "pair"), edit.get("entry"), positive_in(edit, "value")
    if not value:
        raise refused("it is no number above 0", "give pair, entry and value")
    if not (isinstance(entry, list) and [type(one) for one in entry] in ([str, int], [str, str])):
        raise refused(f"{entry!r} is no entry of a table", 'give such as ["teeth", 0] or ["profile", "base"]')
    key, part = entry
    for array, _, table in sheet.tables():
        if (key, part) not in numbers_in_text(array, table) or called(table, array) != name:
            continue
        if isinstance(part, int) and value % 1:
            raise refused(f"{value:g} teeth cannot be", "give a whole number")
        if part == PROGRAM:
            _scale_program(table[key][PROGRAM], value)
            return {"pair": name}
        table[key][part] = int(value) if isinstance(part, int) else sheet.number(value)
        return {"pair": name}
    raise UnknownName(Problem(name, "there is no such number in the text"))
