"""What the oracle asks the program: the only module that knows how the program's words are called."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from click.testing import CliRunner

import compoundkin as ck

RATES = ("position", "velocity", "acceleration", "jerk")
TURNS = ("angle", "angular_velocity", "angular_acceleration", "angular_jerk")
MOVES = ("value", "rate", "second", "third")
STRUCTURE_VIEWS = ("groups", "loops", "graph", "circle")
FORMS = ("text", "markdown", "json")


def catalog_names() -> tuple[str, ...]:
    """The names of the shipped mechanisms."""
    return tuple(ck.exchange.shipped())


def catalog_mechanism(name: str) -> Any:
    """A shipped mechanism."""
    return ck.load(name)


def loaded(path: str) -> Any:
    """The mechanism of a file."""
    return ck.load(path)


def saved(mechanism: Any, path: str) -> None:
    """Write a mechanism to a file."""
    ck.save(mechanism, path)


def structure_of(mechanism: Any) -> Any:
    """What decomposition finds."""
    return ck.decompose(mechanism)


def is_drivable(pair: Any) -> bool:
    """Whether a driver may prescribe what a pair leaves free."""
    from compoundkin.model.pairs.contract import as_drivable

    return as_drivable(pair) is not None


def name_of(structure: Any) -> Any:
    """What a mechanism is called by its graph, frame and drivers."""
    return ck.chains.structure_name(structure)


def mobility_of(mechanism: Any) -> Any:
    """The mobility by count, for general dimensions and at the pose."""
    return ck.mobility_analysis(mechanism)


def motion_of(mechanism: Any, values: Any = None) -> Any:
    """The motion with all derivatives, at the mechanism's own values where none are given."""
    return ck.solve(mechanism, values, order=3)


def driver_values(motion: Any) -> dict[str, Any]:
    """The value of every driver over a motion."""
    return {name: np.asarray(motion.drives[name].value) for name in motion.drives}


def group_modes(motion: Any) -> dict[str, Any]:
    """The sign or number of the configuration in which every group is at the first pose; its margin from the limit."""
    values = {name: float(np.ravel(value)[0]) for name, value in driver_values(motion).items()}
    every = ck.configurations(motion.mechanism, values)
    letters = list(motion.points)
    here = np.array([np.ravel(motion.points[letter].position)[0] for letter in letters])
    there = [np.array([one.points[letter] for letter in letters]) for one in every]
    names = [one.name for one in every]
    gaps = [float(np.max(np.abs(points - here), initial=0.0)) for points in there]
    return {"mode": names[int(np.argmin(gaps))], "gap is rounding": min(gaps) < 1e-6 * motion.size}


def gaps_of(motion: Any) -> Sequence[Any]:
    """Where a motion cannot be assembled, and why."""
    return tuple(ck.gaps(motion))


def configurations_of(mechanism: Any, values: Mapping[str, float]) -> Any:
    """All configurations of a mechanism at one value of every driver."""
    return ck.configurations(mechanism, values)


def circuits_of(mechanism: Any, driver: str) -> Any:
    """The circuits that one driver moves through."""
    return ck.circuits(mechanism, driver)


def centres_of(motion: Any) -> Any:
    """The instant centres of a motion."""
    return ck.instant_centres(motion)


def findings_of(motion: Any) -> Any:
    """What verification finds."""
    return ck.verify(motion)


def equations_of(mechanism: Any) -> Any:
    """The vector-loop equations."""
    return ck.loop_equations(mechanism)


def equation_texts(equation: Any) -> dict[str, str]:
    """An equation as text and as LaTeX."""
    from compoundkin.analysis.equations.expressions import latex, text

    return {"text": text(equation), "latex": latex(equation)}


def alternatives_of(mechanism: Any) -> Sequence[Any]:
    """Every other choice of frame and drivers."""
    return tuple(ck.alternatives(mechanism))


def truss_names(group: Any) -> tuple[str, ...]:
    """The trusses that a group is made of."""
    return tuple(ck.chains.group_truss(group))


def simple_loop_texts(structure: Any, limit: int) -> list[str]:
    """The first loops that pass no link twice."""
    from compoundkin.structure import simple_loops

    return [str(loop) for loop in simple_loops(structure, limit)]


def report_text(subject: Any, form: str) -> str:
    """The report of a motion or a structure as text, Markdown or JSON."""
    return str(getattr(ck.report(subject), form)())


def sketch_svg(mechanism: Any, **options: Any) -> str:
    """The kinematic sketch."""
    return str(ck.draw(mechanism, **options).svg)


def structure_svg(mechanism: Any, view: str) -> str:
    """A picture of the structure."""
    return str(ck.draw(mechanism, kind=view).svg)


def polygon_svg(motion: Any, kind: str) -> str:
    """The polygon of the vectors at one pose."""
    pose = motion.shape[-1] // 3
    return str(ck.draw(motion, kind="polygon", vectors=kind, pose=pose).svg)


def page_html(motion: Any) -> str:
    """The report as a page."""
    return str(ck.page(motion).html)


def equivalent_of(motion: Any, pose: int) -> Any:
    """The linkage that moves like a mechanism with higher pairs at one pose."""
    return ck.figures.equivalent_linkage(motion, at=pose)


def cam_numbers(motion: Any, pair: str) -> dict[str, Any]:
    """What the analysis of a cam pair finds."""
    found = ck.figures.cam_analysis(motion, pair)
    words = ("pressure_angle", "radius_of_curvature", "pitch_radius", "sliding", "roller_rate")
    numbers = {word: getattr(found, word) for word in words}
    return {**numbers, "profile": found.profile, "pitch curve": found.pitch_curve, "warnings": list(found.warnings)}


def inverted(mechanism: Any, frame: str) -> Any:
    """A mechanism with another link as its frame."""
    return ck.with_frame(mechanism, frame)


def verbs() -> tuple[str, ...]:
    """The verbs of the command line."""
    from compoundkin.cli import VERBS

    return tuple(VERBS)


def command(*words: str) -> dict[str, Any]:
    """What a command prints and its exit code."""
    from compoundkin.cli import cli

    result = CliRunner().invoke(cli, list(words), catch_exceptions=True, prog_name="compoundkin")
    error = result.exception
    told = "" if error is None or isinstance(error, SystemExit) else f"{type(error).__name__}: {error}"
    return {"exit code": result.exit_code, "out": result.stdout, "err": result.stderr, "raises": told}


def asked(question: Callable[[], Any]) -> Any:
    """The answer to a question, or the class and the text of what it raises."""
    try:
        return question()
    except Exception as error:
        return {"raises": type(error).__name__, "text": without_addresses(str(error))}


def without_addresses(text: str) -> str:
    """A text without the addresses of objects."""
    return re.sub(r"0x[0-9a-f]{6,}", "0x...", text)
