"""What is recorded of one mechanism, part by part, as plain data."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from tests.oracle import program
from tests.oracle.program import asked

POSES = 25
# Below this a value that should be zero is rounding, and its place means nothing.
ROUNDING = 1e-9
MOST_SHOWN = 64
MOST_LOOPS = 40


def structure(mechanism: Any) -> Any:
    """Composite links, groups, loops, faults, counts, names."""
    found = program.structure_of(mechanism)
    return {
        "pairs": [_pair(pair) for pair in found.pairs],
        "ground": _body(found.ground),
        "groups": [_group(group) for group in found.groups],
        "mobility": _mobility(found.mobility),
        "faults": [_of(fault, "kind", "links", "amount", "text", "remedy") for fault in found.faults],
        "passive": [_of(passive, "link", "on", "at") for passive in found.passive],
        "redundant": [_pair(pair) for pair in found.redundant],
        "loops": [str(loop) for loop in found.loops],
        "simple loops": asked(lambda: program.simple_loop_texts(found, MOST_LOOPS)),
        "graph": asked(lambda: sorted(map(str, found.graph.edges(keys=True)))),
    }


def names(mechanism: Any) -> Any:
    """What the atlas calls the mechanism and its groups."""
    found = program.structure_of(mechanism)
    words = ("title", "mobility", "assortment", "chain", "also", "driven", "derived_from", "parts", "fractionated_at")
    more = ("symmetries", "equivalent_links", "equivalent_pairs", "variety", "code")
    return {
        "name": asked(lambda: _of(program.name_of(found), *words, *more)),
        "trusses": [asked(lambda group=group: program.truss_names(group)) for group in found.groups],
    }


def mobility(mechanism: Any) -> Any:
    """The freedoms by count, for general dimensions and at the pose."""
    found = program.mobility_of(mechanism)
    words = ("gruebler", "generic", "redundant_generic", "drivers", "at_pose", "finite", "determined", "redundant")
    verdicts = ("freed", "undetermined", "rounded", "agrees", "kind", "is_determinate", "verdict")
    gap = None if found.gap is None else _of(found.gap, "pair", "amount")
    return {**_of(found, *words, *verdicts), "passive": [str(one) for one in found.passive], "gap": gap}


def motion(mechanism: Any) -> Any:
    """The motion of all points, links, pairs and drivers with all derivatives, and its gaps."""
    found, told = _solved(mechanism)
    chosen = _chosen(found)
    return {
        "shape": found.shape,
        "warnings": told,
        "assembled": found.assembled[..., chosen],
        "regular": np.count_nonzero(found.regular),
        "points": _rates(found.points, program.RATES, chosen),
        "links": _rates(found.links, program.TURNS, chosen),
        "pairs": _rates(found.pairs, program.MOVES, chosen),
        "drives": _rates(found.drives, program.MOVES, chosen),
        "modes": asked(lambda: program.group_modes(found)),
        "gaps": asked(lambda: [_gap(gap) for gap in program.gaps_of(found)]),
    }


def coarse(mechanism: Any) -> Any:
    """The motion again at every other pose of the grid, backwards: other approaches, other blocks."""
    found, _ = _solved(mechanism)
    chosen = _chosen(found)[::-2]
    values = {name: value[..., chosen] if value.shape[-1:] == found.shape[-1:] else value
              for name, value in program.driver_values(found).items()}  # fmt: skip
    again = _solved(mechanism, values)[0]
    return {
        "assembled": again.assembled,
        "points": _rates(again.points, program.RATES[:2], slice(None)),
        "links": _rates(again.links, program.TURNS[:2], slice(None)),
    }


def configurations(mechanism: Any) -> Any:
    """All configurations at two values of the drivers."""
    found = _solved(mechanism)[0]
    places = sorted({found.shape[-1] // 7, (2 * found.shape[-1]) // 3})
    return [asked(lambda k=k: _every(program.configurations_of(mechanism, _at(found, k)))) for k in places]


def circuits(mechanism: Any) -> Any:
    """Circuits, branches, limit positions and change points, for the first driver."""
    names = [drive.name for drive in mechanism.drives][:2]
    return {name: asked(lambda name=name: _circuits(program.circuits_of(mechanism, name))) for name in names}


def centres(mechanism: Any) -> Any:
    """All instant centres at three poses, up to scale and sign."""
    found = _solved(mechanism)[0]
    chosen = np.unique(np.linspace(0.1, 0.9, 3) * found.shape[-1] // 1).astype(int)
    values = {name: np.broadcast_to(value, found.shape)[..., chosen]
              for name, value in program.driver_values(found).items()}  # fmt: skip
    known = program.centres_of(_solved(mechanism, values)[0])
    return {
        "derivation": [_of(step, "centre", "text") for step in known.derivation()],
        "centres": {" / ".join(couple): _centre(known[couple]) for couple in known},
    }


def findings(mechanism: Any) -> Any:
    """What verification finds."""
    found = program.findings_of(_solved(mechanism)[0])
    return {**_of(found, "passed", "poses", "singular"), "findings": [_finding(one) for one in found.findings]}


def equations(mechanism: Any) -> Any:
    """The vector-loop equations, written out."""
    found = program.equations_of(mechanism)
    written = [program.equation_texts(one) for one in (*found.loops, *found.auxiliary, *found.drivers)]
    unknowns = [_of(one, "kind", "owner", "key") for one in found.unknowns]
    lengths = {name: np.asarray(value) for name, value in found.lengths.items()}
    return {"written": written, "unknowns": unknowns, "lengths": lengths, "is_solvable": found.is_solvable}


def alternatives(mechanism: Any) -> Any:
    """Every other choice of frame and drivers."""
    words = ("frame", "title", "groups", "class_", "configurations", "closed", "faults", "alike", "present")
    return [
        {**_of(one, *words), "drivers": [str(place) for place in one.drivers]}
        for one in program.alternatives_of(mechanism)
    ]


def others(mechanism: Any) -> Any:
    """Cams, the equivalent linkage, the mechanism on its first moving link."""
    found = _solved(mechanism)[0]
    pose = found.shape[-1] // 3
    cams = [pair.name for pair in found.structure.pairs if pair.code in "CF"]
    first = next((name for name in mechanism.links if name != "frame"), "frame")
    return {
        "cams": {name: asked(lambda name=name: program.cam_numbers(found, name)) for name in cams},
        "equivalent": asked(lambda: _file(program.equivalent_of(found, pose))),
        "inverted": asked(lambda: _file(program.inverted(mechanism, first))),
        "written": asked(lambda: _file(mechanism)),
    }


def report(mechanism: Any) -> Any:
    """The report in all forms, of the motion and of the structure."""
    solved = asked(lambda: _solved(mechanism)[0])
    taken = program.structure_of(mechanism)
    known = {} if isinstance(solved, dict) else {"motion": solved}
    subjects = {**known, "structure": taken}
    return {
        f"{name} {form}": asked(lambda one=one, form=form: _text(program.report_text(one, form)))
        for name, one in subjects.items()
        for form in program.FORMS
    }


def pictures(mechanism: Any) -> Any:
    """The pictures of a mechanism as SVG."""
    solved = asked(lambda: _solved(mechanism)[0])
    views = {view: asked(lambda view=view: _text(program.structure_svg(mechanism, view)))
             for view in program.STRUCTURE_VIEWS}  # fmt: skip
    sketch = asked(lambda: _text(program.sketch_svg(mechanism)))
    if isinstance(solved, dict):
        return {**views, "sketch": sketch}
    options = {"ghosts": 3, "paths": True, "vectors": ("velocity", "acceleration")}
    full = asked(lambda: _text(program.sketch_svg(solved, pose=solved.shape[-1] // 3, **options)))
    polygon = asked(lambda: _text(program.polygon_svg(solved, "velocity")))
    return {**views, "sketch": sketch, "full sketch": full, "polygon": polygon}


def reading(mechanism: Any) -> Any:
    """A mechanism written out again, where its file is not refused."""
    return _file(mechanism)


def page(mechanism: Any) -> Any:
    """The report as a page."""
    return _text(program.page_html(_solved(mechanism)[0]))


ALWAYS: dict[str, Callable[[Any], Any]] = {
    "structure": structure, "names": names, "mobility": mobility, "motion": motion, "coarse": coarse,
    "configurations": configurations, "circuits": circuits, "centres": centres, "findings": findings,
    "equations": equations, "alternatives": alternatives, "others": others,
}  # fmt: skip
TEXTS: dict[str, Callable[[Any], Any]] = {"report": report, "pictures": pictures}


def _solved(mechanism: Any, values: Any = None) -> tuple[Any, list[str]]:
    """The motion, a single pose as a row of one, and the warnings that solving gave."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = program.motion_of(mechanism, values)
        if not found.shape:
            alone = {name: np.atleast_1d(value) for name, value in program.driver_values(found).items()}
            found = program.motion_of(mechanism, alone)
    return found, [f"{one.category.__name__}: {one.message}" for one in told]


def _chosen(found: Any) -> Any:
    """The indices of some poses spread over a motion."""
    return np.unique(np.linspace(0, found.shape[-1] - 1, POSES).round().astype(int))


def _at(found: Any, k: int) -> dict[str, float]:
    values = {name: np.broadcast_to(value, found.shape) for name, value in program.driver_values(found).items()}
    return {name: float(np.ravel(value)[k]) for name, value in values.items()}


def _rates(table: Any, words: Iterable[str], chosen: Any) -> dict[str, dict[str, Any]]:
    return {name: {word: np.asarray(getattr(table[name], word))[..., chosen] for word in words} for name in table}


def _every(found: Any) -> Any:
    """All configurations at one value of the drivers; directions in place of angles, which jump."""
    counts = {"names": found.names, "real": int(found.real_count), "possible": found.possible}
    some = list(found)[:MOST_SHOWN]
    return {**counts, "certified": found.certified, "every": [_configuration(one) for one in some]}


def _configuration(one: Any) -> dict[str, Any]:
    directions = np.exp(1j * np.array(list(one.angles.values())))
    margins = {str(group): margin for group, margin in one.margins.items()}
    return {
        "name": one.name,
        "points": np.array(list(one.points.values())),
        "directions": directions,
        "margins": margins,
    }


def _circuits(found: Any) -> Any:
    start = None if found.start is None else _of(found.start, "circuit", "branch", "value")
    toggles = [_of(one, "value", "link", "pair", "circuit", "branch") for one in found.toggles]
    counts = _of(found, "driver", "fixed", "checked", "consistent", "period")
    return {**counts, "start": start, "toggles": toggles, "circuits": [_circuit(one) for one in found.circuits]}


def _circuit(one: Any) -> dict[str, Any]:
    limit = ("value", "greatest", "group", "links", "circuit", "branches")
    change = ("value", "group", "links", "circuit", "branch")
    return {
        **_of(one, "number", "low", "high", "winding", "closed"),
        "branches": [_of(b, "number", "circuit", "low", "high", "open_ends", "name") for b in one.branches],
        "limits": [{**_of(x, *limit), "points": np.array(list(x.configuration.points.values()))} for x in one.limits],
        "changes": [{**_of(x, *change), "name": x.configuration.name} for x in one.changes],
    }


def _centre(one: Any) -> dict[str, Any]:
    """An instant centre, its homogeneous coordinates with the largest one 1."""
    plain = np.asarray(one.homogeneous) / np.array([one.size, one.size, 1.0])
    largest = np.take_along_axis(plain, np.nanargmax(np.abs(np.nan_to_num(plain)), axis=-1)[..., None], axis=-1)
    with np.errstate(all="ignore"):
        return {"homogeneous": plain / largest, "status": one.status, "conditioning": one.conditioning, "how": one.how}


def _finding(one: Any) -> dict[str, Any]:
    if one.value < ROUNDING:
        return {"name": one.name, "passed": one.passed, "value": "rounding", "limit": one.limit}
    return _of(one, "name", "passed", "value", "limit", "pair", "pose")


def _gap(gap: Any) -> dict[str, Any]:
    words = ("design", "first", "last", "open_begin", "open_end", "links", "group", "reason")
    return {**_of(gap, *words), "begin": dict(gap.begin), "end": dict(gap.end)}


def _pair(pair: Any) -> dict[str, Any]:
    told = _of(pair, "name", "code", "members", "letters", "held", "is_simple", "free_is_angle")
    return {**told, "is_drivable": program.is_drivable(pair)}


def _body(body: Any) -> dict[str, Any]:
    driven = [(one.drive.name, one.pair.name, one.parent, one.link, one.is_passive) for one in body.driven]
    return {"links": body.links, "driven": driven}


def _group(group: Any) -> dict[str, Any]:
    pairs = {"inner": [pair.name for pair in group.inner], "outer": [pair.name for pair in group.outer]}
    words = _of(group, "name", "class_", "order", "links", "uses")
    return {**words, **pairs, "bodies": [_body(body) for body in group.bodies]}


def _mobility(count: Any) -> dict[str, Any]:
    pairs = [(one.code, one.held, one.number) for one in count.pairs]
    return {**_of(count, "links", "drivers", "passive", "freedoms", "is_determinate", "formula"), "pairs": pairs}


def _of(thing: Any, *words: str) -> dict[str, Any]:
    return {word: getattr(thing, word) for word in words}


def _text(text: str) -> dict[str, str]:
    return {"hash": sha256(text.encode()).hexdigest(), "text": text}


def _file(mechanism: Any) -> str:
    program.saved(mechanism, "written.toml")
    return Path("written.toml").read_text("utf-8")
