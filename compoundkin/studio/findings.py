"""What the studio shows beside the drawing: reports, plots, pictures and files of a mechanism, as the package has them.

Nothing is computed or drawn in a second way here. Also what another program's file, a link, a name of the catalog or
the lengths of a linkage become as a document.
"""

from __future__ import annotations

import re
from base64 import b64decode, b64encode
from binascii import Error
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import floor, isfinite, log10
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number, wrapped
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.base.suffixes import SUFFIXES, suffix_for
from compoundkin.base.suffixes import Kind as FileKind
from compoundkin.dynamics.force_analysis import loaded_forces
from compoundkin.dynamics.forces import Forces
from compoundkin.kinematics import Motion, solve
from compoundkin.model.attributes import DEGREE_SIGN, EFFORT, FORCE, TABULATED, VELOCITY, Kind
from compoundkin.model.definition import CYLINDERS
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import WRITTEN
from compoundkin.structure import Structure
from compoundkin.studio.edited_document import called, written_place
from compoundkin.studio.wheels import PROGRAM, lift_of, numbers_in_text

if TYPE_CHECKING:
    from compoundkin.programs.dimensions import FreeDimension
    from compoundkin.view.sketch.force_arrows import ForceCourse

Reply: TypeAlias = dict[str, Any]

# So many configurations have a picture; of more links than these instant centres are not shown.
MOST_PICTURES, MOST_CENTRES = 24, 12
# So many branches of circuits can be clicked.
MOST_BRANCHES = 64
# So many plots are drawn at once.
MOST_PLOTS = 8
# Numbers on the canvas are told with so many digits of the mechanism's size: less than a thousandth of a dot.
DIGITS = 6
# A drawing that chooses a configuration keeps dimensions to so many digits of its size.
EXACT = 12
# Of the quantities of a motion, those up to accelerations.
ORDERS = 3


@dataclass(frozen=True, eq=False)
class DrivenStructure:
    """A structure, and the values of its drivers that the window shows; None for their own ranges."""

    structure: Structure
    values: Mapping[str, Number] | None

    @cached_property
    def motion(self) -> Motion:
        """The motion with accelerations. Raises InvalidInput where there is none, and what `solve` does."""
        if self.structure.faults or not self.structure.mechanism.drives:
            raise InvalidInput(Problem("", "it does not move yet", "mend what is missing"))
        return solve(self.structure, self.values)

    @cached_property
    def forces(self) -> Forces | None:
        """The forces under the loads of the file; None where nothing acts. Raises what `force_analysis` does."""
        return loaded_forces(self.motion)

    def at(self, pose: object) -> dict[str, float]:
        """Return the drivers' values at a pose of the window, at the first assembled one without it."""
        drives, good = self.motion.inputs.drives, np.flatnonzero(self.motion.failed[0] == 0)
        if not good.size:
            raise InvalidInput(Problem("", "it cannot be assembled", "mend its dimensions"))
        k = pose if isinstance(pose, int) and 0 <= pose < self.motion.failed.shape[1] else int(good[0])
        return {name: float(np.broadcast_to(v[0], self.motion.failed.shape)[0, k]) for name, v in drives.items()}


# --- dimensions ---------------------------------------------------------------------------------------------


def dimensions(shown: DrivenStructure, question: Mapping[str, Any]) -> Reply:
    """Reply the program by which a browser solves the mechanism again, with its dimensions, as live pages have it."""
    from compoundkin.view.page.live.live_data import LiveData

    if not shown.structure.mechanism.drives or shown.structure.faults:
        raise InvalidInput(Problem("", "it does not move yet", "mend what is missing"))
    motion = solve(shown.structure, shown.values, order=0)
    poses = motion.failed.shape[1]
    live = LiveData(motion, np.arange(poses), list(motion.mechanism.links), ()).data
    start = int(np.argmax(motion.failed[0] == 0))
    counts = list(_counts(shown.structure.mechanism))
    return {"live": {**live, "toml": None}, "counts": counts, "poses": poses, "start": start, "problems": []}


def _counts(mechanism: Mechanism) -> Iterator[Reply]:
    """Yield the numbers of pairs that no program has and the text has: teeth, the radii of profiles."""
    from compoundkin.files.writer import document

    for array, tables in document(mechanism).items():
        for table in tables if array in WRITTEN else ():
            for (key, part), told in numbers_in_text(array, table).items():
                is_lift, is_whole = part == PROGRAM, isinstance(part, int)
                value = lift_of(table[key][part]) if is_lift else table[key][part]
                yield {"pair": called(table, array), "entry": [key, part], "told": told, "value": value,
                       "is_whole": is_whole, "is_angle": is_lift and "pivot" in table[key]}  # fmt: skip


def changed_dimensions(
    shown: DrivenStructure, document: dict[str, Any], values: Mapping[str, float], pose: object
) -> None:
    """Change dimensions in a document: coordinates of links that have some, numbers of pairs, and the drawing.

    Links of letters alone take theirs off the drawing: it becomes that of the pose that is shown, all other dimensions
    as they are. Raises InvalidInput where it cannot be assembled so, UnknownName for what is no dimension.
    """
    from compoundkin.programs.dimensions import StatedDimensions, with_dimensions

    mechanism = shown.structure.mechanism
    changed = with_dimensions(mechanism, values)
    digits = EXACT - floor(log10(mechanism.geometry.size))
    known = StatedDimensions(mechanism, shown.motion.inputs.ends).known
    for one in (known[name] for name in values):
        if not one.is_of_link:
            _write_number(document, changed, one, digits)
            continue
        points = document["links"][one.owner].get("points")
        if isinstance(points, dict):
            place = complex(np.ravel(changed.geometry.points[one.owner][one.word])[0])
            points[one.word] = written_place(place, digits)
    if "drawn" not in document:
        return
    motion = solve(changed, shown.at(pose), order=0)
    if motion.failed.any():
        raise InvalidInput(
            Problem("", "with that it cannot be assembled at this pose", "go to another pose, or take less")
        )
    for letter in document["drawn"]:
        if letter in motion.points:
            document["drawn"][letter] = written_place(complex(np.ravel(motion.points[letter].position)[0]), digits)


def _write_number(document: dict[str, Any], changed: Mechanism, one: FreeDimension, digits: int) -> None:
    """Write a pair's number into its table, as a file of the changed mechanism has it."""
    from compoundkin.files.writer import document as written
    from compoundkin.model.pairs import pairs_among

    items = {pair.name: pair for pair in pairs_among(changed.items)}
    array = items[one.owner].table if one.owner in items else CYLINDERS
    names = [name for name, pair in items.items() if pair.table == array] or list(changed.cylinders)
    value = written(changed)[array][names.index(one.owner)].get(one.word)
    for table in document.get(array, ()):
        if called(table, array) == one.owner:
            table[one.word] = _neat(value, digits)
            if value is None:
                del table[one.word]
            return
    raise UnknownName(Problem(one.name, "it is not written in the text", "change it in the text"))


def _neat(value: Any, digits: int) -> Any:
    """Return numbers without the rounding of what has been computed."""
    if isinstance(value, list):
        return [_neat(one, digits) for one in value]
    if isinstance(value, dict):
        return {key: _neat(one, digits) for key, one in value.items()}
    if not isinstance(value, float):
        return value
    found = round(value, digits) + 0.0
    return int(found) if found.is_integer() and abs(found) < 10**EXACT else found


# --- reports ------------------------------------------------------------------------------------------------


def results(shown: DrivenStructure, question: Mapping[str, Any]) -> Reply:
    """Reply the report, section by section as plain HTML, and the names of what can be plotted."""
    from compoundkin.view.page.html_blocks import plain_block
    from compoundkin.view.report import report

    found = report(shown.structure.mechanism)
    sections = [
        {
            "key": one.key,
            "title": one.title or "About",
            "html": "\n".join(_unstyled(plain_block(b)) for b in one.blocks),
        }
        for one in found.sections
    ]
    mechanism = shown.structure.mechanism
    moves = not shown.structure.faults and bool(mechanism.drives)
    return {
        "sections": sections,
        "quantities": [*_quantities(shown.motion), *_figures(shown.forces)] if moves else [],
        "outputs": list(mechanism.outputs) if moves else [],
        "verdict": found.outcome.verdict,
        "problems": [],
    }


_NUMBER, _STYLE = re.compile(r' style="text-align:right[^"]*"'), re.compile(r' style="[^"]*"')


def _unstyled(html: str) -> str:
    """Return HTML with classes in place of styles, which the page's policy forbids; texts have no quotes left."""
    return _STYLE.sub("", _NUMBER.sub(' class="number"', html))


def _quantities(motion: Motion) -> Iterator[str]:
    """Yield the names of positions, velocities and accelerations of all that moves; pins that are points are these."""
    carriers = motion.mechanism.carriers
    owners: Mapping[Kind, Any] = {"points": motion.points, "links": motion.links, "pairs": motion.pairs}
    for kind, own in owners.items():
        for name in own:
            if FRAME in (name, *carriers.get(name, ())) or (kind == "pairs" and name in carriers):
                continue
            yield from (f"{name}.{word}" for word in TABULATED[kind][:ORDERS])


def _figures(found: Forces | None) -> Iterator[str]:
    """Yield the names of what drivers and pairs bear."""
    if found is not None:
        yield from (f"{name}.{EFFORT}" for name in found.drives)
        yield from (f"{name}.{FORCE}" for name in found.pairs)


def plots(shown: DrivenStructure, question: Mapping[str, Any]) -> Reply:
    """Reply a plot of quantities, an SVG picture."""
    from compoundkin.view.plot import plot

    names = question.get("names")
    if not isinstance(names, list) or not all(isinstance(one, str) for one in names) or len(names) > MOST_PLOTS:
        raise InvalidInput(Problem("names", "these are no names of quantities", f"give at most {MOST_PLOTS}"))
    return {"picture": _image(plot(shown.forces or shown.motion, *names).content("svg")), "problems": []}


def forces(shown: DrivenStructure, question: Mapping[str, Any]) -> Reply:
    """Reply what the drivers and the pairs bear under the loads of the file: plots and the section of the report."""
    from compoundkin.view.page.html_blocks import plain_sections
    from compoundkin.view.plot import plot
    from compoundkin.view.report.forces_section import forces_report

    if (found := shown.forces) is None:
        what, remedy = "nothing acts on it", "write units, masses and loads into the text: docs, Forces"
        raise InvalidInput(Problem("", what, remedy))
    efforts = [one for one in _figures(found) if one.endswith(EFFORT)]
    pairs = [f"{one}.length" for one in _figures(found) if one.endswith(FORCE)]
    html = "\n".join(map(_unstyled, plain_sections(forces_report(found).sections)))
    pictures = [_image(plot(found, *names).content("svg")) for names in (efforts, pairs[:MOST_PLOTS]) if names]
    return {"pictures": pictures, "html": html, "problems": []}


def _image(svg: bytes | str) -> str:
    """Return an SVG picture as the address of an image: its styles are then its own."""
    content = svg.encode("utf-8") if isinstance(svg, str) else svg
    return f"data:image/svg+xml;base64,{b64encode(content).decode('ascii')}"


def every_configuration(shown: DrivenStructure, question: Mapping[str, Any]) -> Reply:
    """Reply all configurations at the pose that is shown, each with its picture and whether it is the one shown."""
    from compoundkin.configurations.enumeration import configurations
    from compoundkin.view.sketch import draw

    at = shown.at(question.get("pose"))
    found = configurations(shown.structure, at)
    now = solve(shown.structure, at, order=0)
    size, told = shown.structure.mechanism.geometry.size, []
    for one in list(found)[:MOST_PICTURES]:
        motion = solve(shown.structure, at, order=0, modes=one)
        apart = max(abs(complex(np.ravel(now.points[k].position)[0]) - place) for k, place in one.points.items())
        picture = _image(draw(motion, labels=False).svg)
        told.append({"name": one.name, "picture": picture, "is_shown": bool(apart <= 1e-6 * size)})
    return {"configurations": told, "words": found.count_in_words, "problems": []}


def chosen_configuration(shown: DrivenStructure, name: str, pose: object) -> dict[str, list[float]]:
    """Return where all points are in a configuration at the pose that is shown. Raises UnknownName."""
    from compoundkin.configurations.enumeration import configurations

    found = {one.name: one for one in configurations(shown.structure, shown.at(pose))}
    if name not in found:
        raise UnknownName(Problem(name, "there is no such configuration here", suggestion(name, list(found))))
    digits = EXACT - floor(log10(shown.structure.mechanism.geometry.size))
    return {letter: written_place(place, digits) for letter, place in found[name].points.items()}


def every_circuit(shown: DrivenStructure, question: Mapping[str, Any]) -> Reply:
    """Reply all circuits of a driver: a plot over its range, and the tables of the report."""
    from compoundkin.configurations.circuit_search import circuits
    from compoundkin.view.page.html_blocks import plain_sections
    from compoundkin.view.plot import circuits as circuits_plot
    from compoundkin.view.report.configurations_section import circuits_report

    at, drivers = shown.at(question.get("pose")), list(shown.motion.drives)
    others = {name: value for name, value in at.items() if name != drivers[0]}
    found = circuits(shown.structure, drivers[0], others)
    html = "\n".join(map(_unstyled, plain_sections(circuits_report(found).sections)))
    is_angle = shown.structure.driven_angles[drivers[0]]
    branches = [
        {
            "number": one.number,
            "circuit": one.circuit,
            "name": one.name,
            "range": [float(np.rad2deg(end) if is_angle else end) for end in (one.low, one.high)],
            "is_shown": found.start is not None and found.start.branch == one.number,
        }
        for one in found.branches[:MOST_BRANCHES]
    ]
    unit = DEGREE_SIGN if is_angle else shown.structure.mechanism.unit
    picture = _image(circuits_plot(found).content("svg"))
    return {"picture": picture, "html": html, "branches": branches, "unit": unit, "problems": []}


def chosen_branch(shown: DrivenStructure, number: object, pose: object) -> tuple[dict[str, list[float]], int]:
    """Return where all points are in the middle of a branch, and which pose of the window is nearest to that.

    Raises UnknownName.
    """
    from compoundkin.configurations.circuit_search import circuits

    at, driver = shown.at(pose), next(iter(shown.motion.drives))
    found = circuits(shown.structure, driver, {name: value for name, value in at.items() if name != driver})
    branch = next((one for one in found.branches if one.number == number), None)
    if branch is None:
        raise UnknownName(Problem(str(number), "there is no such branch", f"they are 1 to {len(found.branches)}"))
    digits = EXACT - floor(log10(shown.structure.mechanism.geometry.size))
    away = np.ravel(shown.motion.inputs.drives[driver][0]) - (branch.low + branch.high) / 2
    away = wrapped(away) if shown.structure.driven_angles[driver] else away
    places = {letter: written_place(place, digits) for letter, place in branch.configuration.points.items()}
    return places, int(np.argmin(np.abs(away)))


def overlays(shown: DrivenStructure, question: Mapping[str, Any]) -> Reply:
    """Reply what the canvas can show at each pose beside the drawing: velocities of points, instant centres."""
    from compoundkin.analysis.centres import instant_centres

    motion = shown.motion
    fine = DIGITS - floor(log10(motion.size))
    velocities = {
        k: np.broadcast_to(getattr(point, VELOCITY), motion.failed.shape)[0] for k, point in motion.points.items()
    }
    moving = {k: v for k, v in velocities.items() if FRAME not in motion.mechanism.carriers[k]}
    fastest = max((float(np.nanmax(np.abs(v), initial=0.0)) for v in moving.values()), default=0.0)
    found: dict[str, Any] = {}
    if len(motion.mechanism.links) <= MOST_CENTRES:
        centres = instant_centres(motion)
        for pair in centres:
            place = np.broadcast_to(centres[pair].point, motion.failed.shape)[0]
            found[", ".join(pair)] = [rounded_row(place.real, fine), rounded_row(place.imag, fine)]
    return {
        "forces": _arrows(shown.forces) if shown.forces is not None else None,
        "velocities": {
            k: [rounded_row(v.real / fastest, DIGITS), rounded_row(v.imag / fastest, DIGITS)] for k, v in moving.items()
        }
        if fastest
        else {},
        "centres": found,
        "problems": [],
    }


def _arrows(found: Forces) -> Reply:
    """Return the forces at each pose in parts of the greatest of all, and moments in parts of the greatest of each."""
    from compoundkin.view.sketch.force_arrows import drawn_force_courses, drawn_moment_courses
    from compoundkin.view.sketch.kinematic_sketch import moving_sketch

    scene, fine = moving_sketch(found.motion, 0).scene, DIGITS - floor(log10(found.motion.size))
    arrows, arcs = (drawn(found, scene, 0) for drawn in (drawn_force_courses, drawn_moment_courses))
    greatest = max((float(np.nanmax(np.abs(one.force), initial=0.0)) for one in arrows), default=0.0)

    def placed(one: ForceCourse) -> Reply:
        at = [rounded_row(one.at.real, fine), rounded_row(one.at.imag, fine)]
        return {"at": at, "kind": one.shown.kind, "words": one.shown.description}

    def force(one: ForceCourse) -> list[Any]:
        return [rounded_row(part / greatest, DIGITS) for part in (one.force.real, one.force.imag)]

    return {
        "arrows": [
            {**placed(one), "name": one.shown.name, "force": force(one)} for one in arrows if greatest
        ],
        "arcs": [
            {**placed(one), "name": one.shown.turning, "moment": rounded_row(one.moment / top, DIGITS)}
            for one in arcs if (top := float(np.nanmax(np.abs(one.moment), initial=0.0)))
        ],
        "greatest": greatest,
        "unit": found.units.force,
    }  # fmt: skip


def rounded_row(values: Number, digits: int) -> list[float | None]:
    """Return numbers in a row as JSON has them: rounded, and None for those that are not finite."""
    rounded = np.round(np.asarray(values, dtype=float), digits)
    return [float(one) if isfinite(one) else None for one in np.ravel(rounded)]


# --- files of others ----------------------------------------------------------------------------------------

TIKZ = "tikz"
# What is written besides files of other programs, in order: its kind in the table of suffixes, and what it is.
OWN_FORMS: Mapping[str, tuple[FileKind, str]] = {
    "html": ("report", "report with the moving sketch, a page to send"),
    "markdown": ("report", "report"),
    "svg": ("picture", "picture"),
    TIKZ: ("picture", "picture for LaTeX"),
    **dict.fromkeys(dict.fromkeys(SUFFIXES["program"].values()), ("program", "function")),
}
# Of formats that are a line of text.
PLAIN = suffix_for("report", "text")


def forms(question: Mapping[str, Any]) -> Reply:
    """Reply what a mechanism can be exported as, and the names of the catalog with titles."""
    from compoundkin.files.exchange.known_formats import writable_formats
    from compoundkin.files.shipped_mechanisms import titles

    others = {name: (one.title, one.suffix or PLAIN) for name, one in writable_formats().items()}
    known = {**{name: (title, suffix_for(kind, name)) for name, (kind, title) in OWN_FORMS.items()}, **others}
    return {
        "forms": [{"name": name, "title": title, "suffix": suffix} for name, (title, suffix) in known.items()],
        "catalog": titles(),
        "problems": [],
    }


def exported(shown: DrivenStructure, question: Mapping[str, Any]) -> Reply:
    """Reply a mechanism in another form: its bytes in base 64, the suffix of the file, and what is not converted."""
    from compoundkin.files.exchange.known_formats import writable_formats, write
    from compoundkin.programs.compiled_path import compile, recorded_outputs
    from compoundkin.view.report import report
    from compoundkin.view.sketch import draw

    form, notes = str(question.get("to")), list[str]()
    structure = shown.structure
    kind = OWN_FORMS[form][0] if form in OWN_FORMS else None
    suffix = suffix_for(kind, form) if kind else ""
    if kind == "program":
        outputs, left_out = recorded_outputs(structure)
        content = compile(structure, outputs).source(form, str(question.get("name") or "mechanism")).encode("utf-8")
        notes = [f"Left out: {one}" for one in left_out]
    elif kind is not None:
        content = draw(structure).content(form) if kind == "picture" else report(structure.mechanism).content(form)
    elif form in writable_formats():
        written = write(structure.mechanism, form)
        content, suffix, notes = written.content, writable_formats()[form].suffix or PLAIN, list(written.notes)
    else:
        known = [*OWN_FORMS, *writable_formats()]
        raise UnknownName(Problem("to", f"nothing is exported as {form!r}", suggestion(form, known)))
    return {"content": b64encode(content).decode("ascii"), "suffix": suffix, "notes": notes, "problems": []}


def opened(question: Mapping[str, Any]) -> Reply:
    """Reply the document of what somebody names or gives: of the catalog, by lengths, a link, another program's file.

    Nothing is read from this machine: a file comes as its content.
    """
    from compoundkin.files.exchange.content import Content, as_utf8
    from compoundkin.files.exchange.known_formats import readable_formats, recognised
    from compoundkin.files.mechanism_files import dumps
    from compoundkin.files.shipped_mechanisms import path, shipped
    from compoundkin.synthesis.linkages import linkage_of

    name, content = str(question.get("name", "")).strip(), question.get("content")
    if isinstance(content, str):
        try:
            raw = b64decode(content, validate=True)
        except Error:
            raise InvalidInput(Problem("content", "this is no content in base 64")) from None
        given = Content(as_utf8(raw), name)
    elif name in shipped():
        return {"text": path(name).read_text(encoding="utf-8"), "notes": [], "problems": []}
    elif (made := linkage_of(name)) is not None:
        return {"text": dumps(made), "notes": [], "problems": []}
    elif "://" in name or "\n" in name:
        given = Content(name.encode("utf-8", "surrogatepass"))
    else:
        what = "it is no name of the catalog, no link, and no linkage with its lengths"
        raise UnknownName(Problem(name, what, suggestion(name, list(shipped()))))
    found = recognised(given, readable_formats()).read(given)
    return {"text": dumps(found.mechanism), "notes": list(found.notes), "problems": []}


# Questions about what moves, and those for which no mechanism is needed.
OF_MECHANISMS: Mapping[str, Callable[[DrivenStructure, Mapping[str, Any]], Reply]] = {
    "dimensions": dimensions,
    "results": results,
    "plots": plots,
    "configurations": every_configuration,
    "circuits": every_circuit,
    "forces": forces,
    "overlays": overlays,
    "export": exported,
}
OF_FILES: Mapping[str, Callable[[Mapping[str, Any]], Reply]] = {"forms": forms, "open": opened}
