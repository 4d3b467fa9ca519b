"""`answer`: what the studio is asked of a document, and what it replies, as plain data.

`structure` is what follows from letters, with where everything is; `motion` is all poses over the range of the drivers;
`edit` changes the text, `offers` says which edits could. All other questions are those of `findings`, and of
`drawn_curves` for the pen. What is not yet a mechanism is shown as far as it goes: what cannot be part of one is set
aside, named with its remedy, and the rest is taken apart (`reading`).
"""

from __future__ import annotations

import cmath
import warnings
from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from itertools import product
from math import floor, isfinite, log10
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import CompoundkinError, InvalidInput, InvalidMechanism, Problem, suggestion
from compoundkin.base.poses import Pose
from compoundkin.files import toml_text
from compoundkin.files.mechanism_files import changed_text
from compoundkin.files.parsed_document import located
from compoundkin.kinematics import Motion
from compoundkin.kinematics.gaps import gaps
from compoundkin.model.attributes import DEGREE_SIGN
from compoundkin.model.geometry import FRAME, Geometry
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import WRITTEN
from compoundkin.model.pairs.contract import Pair, as_drivable
from compoundkin.model.pairs.cylinder import Stroke
from compoundkin.model.pairs.symbols import Groove, Outline, Wheel
from compoundkin.model.units import LENGTHS
from compoundkin.structure import Fault, Structure
from compoundkin.studio.drawn_curves import OF_CURVES
from compoundkin.studio.edited_document import Document, Placement, written_place
from compoundkin.studio.edits import edited
from compoundkin.studio.findings import (
    DIGITS,
    OF_FILES,
    OF_MECHANISMS,
    DrivenStructure,
    Reply,
    changed_dimensions,
    chosen_branch,
    chosen_configuration,
    rounded_row,
)
from compoundkin.studio.reading import (
    INDEXED,
    MOST_POSES,
    Reading,
    document_of,
    drawing_of,
    driver_ranges,
    is_as_drawn,
    reading_of,
    syntax_of,
)

# A document may have so many characters.
MOST_TEXT = 200_000
# What may be done is asked of so many edits at once.
MOST_OFFERS = 40
# The drawing of another pose is written with so many digits of its size.
DRAWN = 9


def answer(document: str, question: Mapping[str, Any]) -> Reply:
    """Return what a question asks of a document, the text of a mechanism file in TOML or JSON, as plain data.

    `question["ask"]` is "structure", "motion", "edit" (`question["edit"]`, with `do` and what it needs, and `pose`: at
    which pose of the motion the drawing is shown), or another of QUESTIONS, such as "plots" or "export". A reply has
    `problems`, each with `where`, `what` and `remedy`; nothing is raised for a document that is not yet a mechanism,
    nor for a question that cannot be answered.

    >>> text = 'format = 1\\ntitle = "Crank"\\n[links]\\nframe.points = ["A"]\\n[drawn]\\nA = [0, 0]\\n'
    >>> bar = {"do": "bar", "from": {"point": "A"}, "to": {"at": [3, 4]}}
    >>> reply = answer(text, {"ask": "edit", "edit": bar})
    >>> answer(reply["text"], {"ask": "structure"})["mobility"]
    {'freedoms': 1, 'sum': 'F = 3·1 − 2·1 = 1'}
    """
    asked = question.get("ask")
    try:
        if asked not in QUESTIONS:
            raise InvalidInput(
                Problem("ask", f"there is no question {asked!r}", suggestion(str(asked), list(QUESTIONS)))
            )
        if len(document) > MOST_TEXT:
            raise InvalidInput(Problem("", f"the document is longer than {MOST_TEXT:,} characters", "shorten it"))
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            return {"ask": asked, **QUESTIONS[asked](document, question)}
    except CompoundkinError as error:
        return {"ask": asked, "text": document, "problems": [_problem(one) for one in error.problems]}


def _problem(one: Problem) -> dict[str, str]:
    return {"where": one.where, "what": one.what, "remedy": one.remedy}


# --- replies ------------------------------------------------------------------------------------------------


def _structure(document: str, question: Mapping[str, Any]) -> Reply:
    """Reply what follows from letters: links, pairs, groups, mobility, faults; and where everything is."""
    try:
        reading = reading_of(document)
    except InvalidMechanism as error:
        told = located(error, document) if syntax_of(document) == "toml" else error
        return {"problems": [_problem(one) for one in told.problems], "is_text": False}
    return _structure_of(reading)


def _structure_of(reading: Reading) -> Reply:
    """Return what follows from a reading, as plain data."""
    drawing, structure, mechanism = drawing_of(reading), reading.structure, reading.mechanism
    colours, driven = _colours(structure), structure.driven if structure else {}
    return {
        "is_text": True,
        "is_as_drawn": mechanism is None or is_as_drawn(mechanism),
        "title": str(reading.document.get("title", "")),
        "unit": mechanism.unit if mechanism else "",
        "units": list(LENGTHS),
        "links": [
            {
                "name": name,
                "points": list(letters),
                "colour": colours.get(name),
                "is_aside": name in reading.aside.get("links", ()),
            }
            for name, letters in reading.letters.items()
        ],
        **_placed(reading, drawing),
        "pairs": list(_pairs(mechanism, drawing)) if mechanism else [],
        "drives": [
            {
                "name": name,
                "link": step.link,
                "on": step.parent,
                "points": list(step.pair.letters),
                "is_angle": step.pair.free_is_angle,
            }
            for name, step in driven.items()
        ],
        "groups": [
            {"name": group.name, "links": list(group.links), "colour": colours[group.links[0]]}
            for group in (structure.groups if structure else ())
        ],
        "mobility": _mobility(reading),
        "faults": list(_faults(reading)),
        "problems": [_problem(one) for one in reading.problems if not _is_fault(one, reading)],
        "moves": bool(structure and not structure.faults and driven and not structure.mechanism.unplaced),
        "may_move": reading.may_move and bool(driven),
    }


def _placed(reading: Reading, drawing: Placement) -> Reply:
    """Return where points and links are, and the pins: points that several links have."""
    carriers: dict[str, list[str]] = {}
    for name, letters in reading.letters.items():
        for letter in letters:
            carriers.setdefault(letter, []).append(name)
    return {
        "points": {k: [p.real, p.imag] for k, p in drawing.places.items() if k in carriers},
        "angles": {name: cmath.phase(along) for name, (_, along) in drawing.poses.items()},
        "origins": {name: [origin.real, origin.imag] for name, (origin, _) in drawing.poses.items()},
        "pins": {letter: names for letter, names in carriers.items() if len(names) > 1},
    }


def _colours(structure: Structure | None) -> dict[str, int]:
    """Return the colours of links: 0 of the frame and driven links, then one for each group."""
    if structure is None:
        return {}
    found = dict.fromkeys(structure.ground.links, 0)
    for k, group in enumerate(structure.groups):
        found |= dict.fromkeys(group.links, k + 1)
    return found


def _pairs(mechanism: Mechanism, drawing: Placement) -> Iterator[dict[str, Any]]:
    """Yield the pairs that are no pins: those with a line, where it lies in the frame of the first link; shapes."""
    geometry: Geometry | None = None if mechanism.unplaced else mechanism.geometry
    for pair in mechanism.written_pairs:
        told: dict[str, Any] = {"name": pair.name, "kind": pair.title, "code": pair.code}
        told |= {"links": list(pair.members), "points": list(pair.letters)}
        if geometry is not None:
            guide = pair.ends(geometry)[0]
            if guide.direction is not None:
                point, along = (complex(np.ravel(np.asarray(one))[0]) for one in (guide.point, guide.direction))
                told["guide"] = [point.real, point.imag, cmath.phase(along)]
            told["shapes"] = list(_shapes(pair, pair.ends(geometry), drawing)) if pair.code != "P" else []
        told["is_cylinder"] = isinstance(pair, Stroke)
        yield told


# A profile is told by so many points at most.
PROFILE = 240


def _shapes(pair: Pair, ends: Any, drawing: Placement) -> Iterator[dict[str, Any]]:
    """Yield wheels and profiles of a pair, each in the frame of its link."""
    lying = [drawing.poses.get(name, (0j, 1 + 0j)) for name in pair.members]
    for mark in pair.glyph(ends, tuple(Pose.of(np.array([z]), np.array([u])) for z, u in lying)):
        if isinstance(mark, Wheel):
            at, radius = (complex(np.ravel(one)[0]) for one in (mark.at, mark.radius))
            told = {"at": [at.real, at.imag], "radius": radius.real, "is_ring": mark.is_ring}
            yield {"link": pair.members[mark.member], "teeth": int(np.ravel(mark.teeth)[0]), **told}
        elif isinstance(mark, Outline | Groove):
            line = np.atleast_2d(mark.line)[0]
            line = line[:: max(1, len(line) // PROFILE)]
            told = {"line": [line.real.tolist(), line.imag.tolist()]}
            yield {"link": pair.members[mark.member], "is_closed": isinstance(mark, Outline) and mark.closed, **told}


def _mobility(reading: Reading) -> dict[str, Any]:
    """Return the mobility and its sum, F = 3 (n - 1) - what the pairs hold; links without a frame are counted too."""
    if reading.structure is not None:
        count = reading.structure.mobility
        moving, passive = count.links - 1, count.passive
        held: dict[int, int] = {}
        for one in count.pairs:
            held[one.held] = held.get(one.held, 0) + one.number
    else:
        moving, passive = len(reading.letters.keys() - {FRAME}), 0
        carried = [letter for letters in reading.letters.values() for letter in letters]
        held = {2: len(carried) - len(set(carried))}
        for name in WRITTEN:
            tables = reading.document.get(name)
            if isinstance(tables, list):
                own = WRITTEN[name].held
                held[own] = held.get(own, 0) + len(tables)
    freedoms = 3 * moving - sum(h * n for h, n in held.items()) - passive
    terms = "".join(f" − {f'{h}·' if h > 1 else ''}{n}" for h, n in sorted(held.items(), reverse=True) if n)
    minus = f" − {passive}" if passive else ""
    return {"freedoms": freedoms, "sum": f"F = 3·{moving}{terms}{minus} = {freedoms}".replace("-", "−")}


def _faults(reading: Reading) -> Iterator[dict[str, Any]]:
    """Yield what stands in the way of a motion, each with its remedy and the edits that mend it."""
    structure, own = reading.structure, reading.letters
    if not own:
        yield _fault("", "there is no link", "drag from an empty place: a bar")
    elif FRAME not in own:
        ends = dict.fromkeys(letters[0] for letters in own.values() if letters)
        fixes = [_fix(f"ground {letter}", do="ground", point=letter) for letter in list(ends)[:4]]
        yield _fault("", "no point is fixed: there is no frame", "ground a point (key G)", fixes)
    for name in reading.aside.get("links", ()):
        if name in own:
            yield _fault(
                name, f"{name} is loose: it is joined to nothing", "drop one of its points on a point of another link"
            )
    drives = reading.document.get("drives")
    for name in reading.aside.get("drives", ()):
        indexed = INDEXED.match(name)
        table = drives[int(indexed[2])] if isinstance(drives, list) and indexed else {}
        called = str(table.get("name", table.get("link", ""))) if isinstance(table, dict) else ""
        text = next((one.what for one in reading.problems if one.where.startswith(name)), "it drives nothing")
        fixes = [_fix(f"remove the driver {called}", do="delete", drive=called)] if called else []
        yield _fault(called, f"the driver {called} is set aside: {text}", "remove it", fixes)
    if structure is None:
        return
    for fault in structure.faults:
        told = _fault(", ".join(fault.links), fault.text, fault.remedy, list(_fixes(structure, fault)))
        yield {**told, "links": list(fault.links), "kind": fault.kind}
    if not structure.faults and not structure.mechanism.drives and len(own) > 1:
        yield _fault("", structure.mobility.verdict, "take a bar out, or leave it: it stands still")
    if structure.mechanism.unplaced:
        yield _fault("", "points have no place", "give them places in [drawn]")


def _is_fault(problem: Problem, reading: Reading) -> bool:
    """Return whether a problem is told among the faults: of a link or a driver that is set aside, of the frame."""
    head, _, rest = problem.where.partition(".")
    name, aside = rest.partition(".")[0], reading.aside.get("links", ())
    is_of_link = head == "links" and name in ("", FRAME, *aside)
    is_of_point = head == "drawn" and any(name in letters for letters in reading.letters.values())
    return is_of_link or is_of_point or head.startswith("drives[")


def _fault(where: str, what: str, remedy: str, fixes: list[Any] | None = None) -> Reply:
    return {"where": where, "what": what, "remedy": remedy, "fixes": fixes or [], "links": [where], "kind": ""}


def _fix(words: str, **edit: str) -> dict[str, Any]:
    return {"words": words, "edit": edit}


# So many remedies have a button.
FIXES = 4


def _fixes(structure: Structure, fault: Fault) -> Iterator[dict[str, Any]]:
    """Yield the edits that mend a fault: a driver more, or one less."""
    mechanism = structure.mechanism
    if fault.kind == "over":
        for drive in [one for one in mechanism.drives if {one.link, one.on} & set(fault.links)][:FIXES]:
            yield _fix(f"remove the driver {drive.name}", do="delete", drive=drive.name)
        return
    driven = {(one.link, one.on) for one in mechanism.drives}
    sliding = {name for one in mechanism.written_pairs if one.code == "P" for name in one.members}
    blocks = {name for name in sliding - {FRAME} if len(mechanism.links[name].points) == 1}
    pairs = [one for one in structure.pairs if one.table or not blocks & set(one.members)]
    choices = [one for one in pairs if _may_be_driven(one, fault, driven)]
    for pair in sorted(choices, key=lambda one: FRAME not in one.members)[:FIXES]:
        on, link = sorted(pair.members, key=lambda name: name != FRAME)
        if isinstance(pair, Stroke):
            yield _fix(f"drive {pair.name}", do="driver", cylinder=pair.name)
            continue
        words = f"drive {link}{'' if on == FRAME else f' on {on}'} at {pair.letters[0]}"
        yield _fix(words, do="driver", point=pair.letters[0], link=link, on=on)


def _may_be_driven(pair: Pair, fault: Fault, driven: set[tuple[str, str]]) -> bool:
    inside = len(pair.members) == 2 and not set(fault.links).isdisjoint(pair.members)
    is_free = pair.members not in driven and pair.members[::-1] not in driven
    # of the pairs that are written only slides can be driven by a gesture
    return inside and is_free and bool(as_drivable(pair)) and (not pair.table or pair.code == "P")


def _motion(document: str, question: Mapping[str, Any]) -> Reply:
    """Reply all poses of all points over the range of the drivers, and where it cannot be assembled: why.

    With its structure where that moves though it seemed not to near the drawing.
    """
    reading = reading_of(document).searched
    motion = reading.motion
    if motion is None:
        return {"problems": [], "poses": 0}
    good = motion.failed[0] == 0
    if len(good) > MOST_POSES:
        raise InvalidInput(Problem("drives", f"there are more than {MOST_POSES} poses", "take fewer values"))
    places, shape = _known_places(motion), motion.failed.shape
    digits = DIGITS - floor(log10(motion.size))

    def row(values: Number, digits: int = digits) -> list[float | None]:
        return rounded_row(np.broadcast_to(np.atleast_2d(values), shape)[0], digits)

    drives, origins = dict[str, Reply](), dict[str, list[Any]]()
    for name in motion.drives:
        values, is_angle = motion.inputs.drives[name][0], motion.structure.driven_angles[name]
        unit = DEGREE_SIGN if is_angle else motion.mechanism.unit
        drives[name] = {"values": row(np.rad2deg(values) if is_angle else values, DIGITS), "unit": unit}
    for name in dict.fromkeys(name for pair in motion.mechanism.written_pairs for name in pair.members):
        if name != FRAME:
            z, u = motion.poses[name].z.c[0], motion.poses[name].u.c[0]
            origins[name] = [row(np.real(z)), row(np.imag(z)), row(np.angle(u), DIGITS)]
    return {
        "poses": len(good),
        "drives": drives,
        "points": {letter: [row(place.real), row(place.imag)] for letter, place in places.items()},
        "origins": origins,
        "assembled": [int(one) for one in good],
        "start": _nearest(motion, drawing_of(reading)),
        "gaps": [] if good.all() else list(_gaps(motion)),
        "problems": [],
        **({"structure": _structure_of(reading)} if reading.is_searched else {}),
    }


def _gaps(motion: Motion) -> Iterator[dict[str, Any]]:
    """Yield the poses that are not assembled, with the reason, and the circles that do not meet."""
    for gap in gaps(motion):
        circles = [] if gap.pair else list(_circles(motion, gap.links))
        yield {"from": gap.first, "to": gap.last, "why": gap.reason, "links": list(gap.links), "circles": circles}


def _known_places(motion: Motion) -> dict[str, Number]:
    """Return where points are, (1, poses); where the motion is not assembled, those that are known before its group."""
    places = {letter: np.atleast_2d(point.position) for letter, point in motion.points.items()}
    if not motion.failed.any():
        return places
    ranks = {name: k + 1 for k, group in enumerate(motion.structure.groups) for name in group.links}
    for letter, on in motion.mechanism.carriers.items():
        link = min(on, key=lambda name: ranks.get(name, 0))
        pose, p = motion.poses[link], np.ravel(motion.mechanism.geometry.points[link][letter])[0]
        is_known = (motion.failed > 0) & (motion.failed > ranks.get(link, 0))
        raw = np.broadcast_to(pose.z.c[0] + pose.u.c[0] * p, motion.failed.shape)
        places[letter] = np.where(is_known, raw, np.broadcast_to(places[letter], motion.failed.shape))
    return places


def _circles(motion: Motion, links: Sequence[str]) -> Iterator[dict[str, Any]]:
    """Yield the circles of a group that does not close: about what is known, through where its links are joined."""
    carriers, geometry = motion.mechanism.carriers, motion.mechanism.geometry.points
    for name in links:
        outer = [k for k in geometry[name] if set(carriers[k]) - set(links)]
        inner = [k for k in geometry[name] if k not in outer and len(carriers[k]) > 1]
        for known, other in product(outer, inner):
            radius = abs(complex(np.ravel(geometry[name][other] - geometry[name][known])[0]))
            yield {"point": known, "radius": radius, "link": name}


def _nearest(motion: Motion, drawing: Placement) -> int:
    """Return the pose that is nearest to the drawing."""
    away = np.zeros(motion.failed.shape[1])
    for letter, place in drawing.places.items():
        if letter in motion.points:
            away = away + np.abs(np.atleast_2d(motion.points[letter].position)[0] - place)
    return int(np.nanargmin(np.where(motion.failed[0] == 0, away, np.nan)))


def _edit(document: str, question: Mapping[str, Any]) -> Reply:
    """Reply the text of the changed document, with what was made; with its structure too where that is asked for."""
    found = _edited(document, question)
    return {**found, "structure": _structure(found["text"], {})} if question.get("with") == "structure" else found


def _edited(document: str, question: Mapping[str, Any]) -> Reply:
    """Return the text of the changed document, with what was made. Raises InvalidInput, UnknownName."""
    edit, pose = question.get("edit"), question.get("pose")
    if not isinstance(edit, dict):
        raise InvalidInput(Problem("edit", "there is no edit", 'give {"do": ...} with what it needs'))
    if edit.get("do") == "set":
        changes = {str(edit.get("name")): str(edit.get("value"))}
        return {"text": changed_text(document, changes, syntax_of(document)), "made": {}, "problems": []}
    reading = reading_of(document)
    wanted = deepcopy(reading.document)
    is_at = isinstance(pose, int) and not isinstance(pose, bool)
    drawing = drawing_of(reading, pose if is_at else None)
    if is_at and isinstance(wanted.get("drawn"), dict):
        # who changes it at another pose draws that one
        digits = DRAWN - floor(log10(drawing.size))
        for letter in wanted["drawn"]:
            if letter in drawing.places:
                wanted["drawn"][letter] = written_place(drawing.places[letter], digits)
    made = _solved_edit(reading, wanted, edit, pose)
    if made is None:
        made = edited(wanted, edit, drawing)
    text = toml_text.changed(document, wanted, syntax_of(document), read=document_of)
    return {"text": text, "made": made, "problems": []}


def _solved_edit(reading: Reading, wanted: Document, edit: Mapping[str, Any], pose: object) -> Reply | None:
    """Change a document by an edit that needs a solution, and return what was made; None for any other edit."""
    match edit.get("do"):
        case "configuration":
            wanted["drawn"], made = chosen_configuration(_shown(reading), str(edit.get("name")), pose), {}
        case "branch":
            wanted["drawn"], there = chosen_branch(_shown(reading), edit.get("number"), pose)
            made = {"pose": there}
        case "dimensions":
            changed_dimensions(_shown(reading), wanted, _numbers(edit.get("values")), pose)
            return {}
        case _:
            return None
    # the drawing chooses the configuration from now on
    wanted.pop("modes", None)
    return made


def _numbers(values: Any) -> dict[str, float]:
    """Return numbers by name out of a question. Raises InvalidInput."""
    if isinstance(values, dict) and all(type(one) in (int, float) and isfinite(one) for one in values.values()):
        return {str(name): float(one) for name, one in values.items()}
    raise InvalidInput(Problem("values", "these are no numbers by name", 'give {"crank.B.x": 20, ...}'))


def _offers(document: str, question: Mapping[str, Any]) -> Reply:
    """Reply of each of several edits why it cannot be done; "" where it can."""
    edits = question.get("edits")
    if not isinstance(edits, list) or len(edits) > MOST_OFFERS:
        raise InvalidInput(Problem("edits", "these are no edits", f"give a list of at most {MOST_OFFERS}"))
    reading = reading_of(document)
    drawing = drawing_of(reading)

    def reason(edit: Any) -> str:
        try:
            edited(deepcopy(reading.document), edit if isinstance(edit, dict) else {}, drawing)
        except CompoundkinError as error:
            return "; ".join(f"{one.what}{f' ({one.remedy})' if one.remedy else ''}" for one in error.problems)
        return ""

    return {"why": [reason(edit) for edit in edits], "problems": []}


def _shown(reading: Reading) -> DrivenStructure:
    """Return the structure with the drivers' values that are shown. Raises InvalidInput where there is none."""
    reading = reading.searched
    if reading.structure is None:
        raise InvalidInput(Problem("", "it is no mechanism yet", "mend what is missing"))
    return DrivenStructure(reading.structure, driver_ranges(reading.structure.mechanism))


def _finding(document: str, question: Mapping[str, Any]) -> Reply:
    """Reply what the package finds of the mechanism."""
    return OF_MECHANISMS[question["ask"]](_shown(reading_of(document)), question)


def _file(document: str, question: Mapping[str, Any]) -> Reply:
    """Reply what is asked of no document."""
    return OF_NOTHING_DRAWN[question["ask"]](question)


# Questions for which no document is needed.
OF_NOTHING_DRAWN = {**OF_FILES, **OF_CURVES}


QUESTIONS = {
    **{"structure": _structure, "motion": _motion, "edit": _edit, "offers": _offers},
    **dict.fromkeys(OF_MECHANISMS, _finding),
    **dict.fromkeys(OF_NOTHING_DRAWN, _file),
}
