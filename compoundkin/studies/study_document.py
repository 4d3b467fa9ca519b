"""Study files in TOML or JSON: their keys, reader, writer and JSON Schema. Angles are in degrees.

Reader, writer and schema follow one table of keys. All problems of a file are found in one reading.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from compoundkin.base.errors import CompoundkinError, InvalidInput, InvalidMechanism, Problem, suggestion
from compoundkin.files import exact_numbers, load
from compoundkin.files.json_schema import DIALECT, FRAGMENTS, closed_table, schema
from compoundkin.files.mechanism_files import written_text
from compoundkin.files.parsed_document import heading, known_syntax
from compoundkin.files.read_values import bad, coordinate, described, numbers, place, wrong
from compoundkin.files.reader import read
from compoundkin.files.recovery import Recovery
from compoundkin.files.shipped_mechanisms import resolve
from compoundkin.files.writer import document
from compoundkin.kinematics.configuration import Configuration
from compoundkin.kinematics.driver_values import by_name
from compoundkin.model.attributes import OF_DRIVERS
from compoundkin.model.elements import Drive
from compoundkin.model.fields import Key
from compoundkin.model.laws.law_numbers import SEGMENTS
from compoundkin.model.laws.motion_programs import ProgramSegment
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import pairs_among
from compoundkin.programs.dimensions import LAW
from compoundkin.structure import decompose
from compoundkin.studies.samples import SAMPLES
from compoundkin.studies.samples.design_sample import DesignSample
from compoundkin.studies.samples.grid_sample import TableSample
from compoundkin.studies.samples.variation import Variation
from compoundkin.studies.samples.variations import variation_from, variations_of

# Tables of a single number.
_UNITS = {"rad", "polar"}


def study_arguments(document: Mapping[str, Any], folder: Path, where: str = "") -> dict[str, Any]:
    """Return the arguments of `study` in a document.

    Paths are relative to a folder. Raises InvalidInput listing all problems.
    """
    log = Recovery({})
    _check_version(document.get(FORMAT), log)
    known = [FORMAT, *(key.name for key in HEAD), *OTHERS]
    given = {name: value for name, (value, _) in log.recognized(document, known, "").items()}
    head = log.table({key.name: given[key.name] for key in HEAD if key.name in given}, HEAD, "")
    mechanism = _mechanism(given, folder, log)
    angles = decompose(mechanism).driven_angles if mechanism else {}
    found = {
        MECHANISM: mechanism,
        DIMENSIONS: _dimensions(given, mechanism, angles, folder, log),
        **head,
        **_driven(given, mechanism, angles, log),
        **_whole(given, MODES, "an assembly mode", log),
        **_whole(given, SAMPLE, "a number of levels", log),
    }
    if log.problems:
        raise InvalidInput(log.problems, heading=heading(log.problems, where or "study file"))
    return found


def _check_version(version: Any, log: Recovery) -> None:
    if isinstance(version, bool) or version not in FORMATS:
        what = "it is missing" if version is None else f"{described(version)} is not a known version of the format"
        log.report(bad(FORMAT, what, f"known: {', '.join(f'format = {one}' for one in FORMATS)}"))


def _mechanism(given: Mapping[str, Any], folder: Path, log: Recovery) -> Mechanism | None:
    """Return the mechanism of a path, a name, or a document in the file. None where it is broken."""
    said = given.get(MECHANISM)
    try:
        if isinstance(said, dict):
            return read(said)
        if isinstance(said, str) and said:
            beside = folder / said
            return load(beside if beside.is_file() else resolve(said))
    except CompoundkinError as error:
        own = f"{MECHANISM}." if isinstance(said, dict) else f"{MECHANISM} "
        log.problems += [Problem(f"{own}{one.where}", one.what, one.remedy) for one in error.problems]
        return None
    how = 'write "press.toml", the path of its file, or the name of a shipped mechanism'
    missing = MECHANISM not in given
    log.report(bad(MECHANISM, "it is missing", how) if missing else wrong(MECHANISM, said, "a name", how))
    return None


def _dimensions(
    given: Mapping[str, Any], mechanism: Mechanism | None, angles: Mapping[str, bool], folder: Path, log: Recovery
) -> dict[str, Any]:
    """Return variations by dimension; for a table its columns."""
    found: dict[str, Any] = {}
    if isinstance(path := given.get(DIMENSIONS), str) and path:
        return _columns(folder / path, given, log)
    for name, raw in _table(given, DIMENSIONS, log).items():
        where = f"{DIMENSIONS}.{name}"
        if whole := _unquoted(raw):
            log.report(bad(where, "this is a table of tables", f'write the name in quotes: "{name}.{whole}" = ...'))
            continue
        is_angle = is_angle_dimension(mechanism, angles, name) if mechanism else None
        data = variation_data(raw, where, is_angle, log)
        try:
            found |= {} if data is None else {name: variation_from(where, data)}
        except InvalidInput as error:
            log.problems += error.problems
    return found


def _columns(path: Path, given: Mapping[str, Any], log: Recovery) -> dict[str, Any]:
    if given.get(SAMPLE) != TableSample.word:
        how = f'write {SAMPLE} = "{TableSample.word}"'
        log.report(bad(SAMPLE, "the dimensions are the columns of a table", how))
    try:
        return variations_of(path)
    except InvalidInput as error:
        log.problems += error.problems
        return {}


def _unquoted(raw: Any) -> str:
    """Return the rest of a dotted name that TOML read as nested tables, as it is not quoted."""
    if not isinstance(raw, dict):
        return ""
    inner = next((key for key, one in raw.items() if isinstance(one, dict) and not _UNITS.issuperset(one)), "")
    return ".".join(filter(None, (inner, _unquoted(raw.get(inner)))))


def _driven(
    given: Mapping[str, Any], mechanism: Mechanism | None, angles: Mapping[str, bool], log: Recovery
) -> dict[str, dict[str, Any]]:
    """Return values and rates, each by driver."""
    found: dict[str, dict[str, Any]] = {}
    for name, raw in _table(given, DRIVES, log).items() if DRIVES in given else ():
        where = f"{DRIVES}.{name}"
        if mechanism is not None and name not in angles:
            log.report(bad(where, f"there is no driver {name!r}", suggestion(name, list(angles))))
        for key, value in log.table(raw, DRIVEN, where, angles.get(name)).items():
            found.setdefault(key, {})[name] = value
    return found


def _whole(given: Mapping[str, Any], key: str, what: str, log: Recovery) -> dict[str, Any]:
    """Return a text, or whole numbers by name."""
    said = given.get(key)
    if key not in given or (isinstance(said, str) and said):
        return {key: said} if said else {}
    found = _table(given, key, log)
    for name, number in found.items():
        if isinstance(number, bool) or not isinstance(number, int):
            log.report(wrong(f"{key}.{name}", number, what))
    return {key: found}


def _table(given: Mapping[str, Any], name: str, log: Recovery) -> Mapping[str, Any]:
    """Return a table of the file that must not be empty."""
    said = given.get(name)
    if isinstance(said, dict) and said:
        return said
    error: InvalidMechanism = (
        bad(name, "it is missing", OTHERS[name]) if not said else wrong(name, said, "a table", OTHERS[name])
    )
    log.report(error)
    return {}


class DescribesStudy(Protocol):
    """The arguments of a study by name."""

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism whose dimensions vary."""

    @property
    def dimensions(self) -> Mapping[str, Variation]:
        """The variation of each dimension."""

    @property
    def outputs(self) -> Any:
        """The outputs of each design."""

    @property
    def sample(self) -> DesignSample:
        """The sample of designs."""


def study_text(study: DescribesStudy, form: str) -> str:
    """Return the text of a study's file in a form, "toml" or "json"."""
    return written_text(study_document(study), known_syntax(form))


def study_document(study: DescribesStudy) -> dict[str, Any]:
    """Return the document of a study, with its mechanism. Raises InvalidInput for outputs that are Python functions."""
    if isinstance(study.outputs, Mapping):
        what, remedy = "a Python function cannot be written to a file", "write outputs by their names"
        raise InvalidInput(Problem(OUTPUTS, what, remedy))
    angles = decompose(study.mechanism).driven_angles
    dimensions = {
        name: variation_entry(one.data, is_angle_dimension(study.mechanism, angles, name))
        for name, one in study.dimensions.items()
    }
    out = {
        FORMAT: FORMATS[-1],
        OUTPUTS: list(study.outputs),
        **study.sample.data,
        TIME: _times(getattr(study, TIME, None)),
        MODES: _modes(getattr(study, MODES, None)),
        DIMENSIONS: dimensions,
        DRIVES: _drives(study, angles),
        MECHANISM: document(study.mechanism),
    }
    return {key: value for key, value in out.items() if value not in (None, {})}


def _times(time: Any) -> Any:
    return None if time is None else exact_numbers.values(time, False)


def _modes(modes: Any) -> Any:
    """Return modes by links, or the name of a configuration."""
    if isinstance(modes, Mapping):
        return {link: int(mode) for link, mode in modes.items()}
    return modes.name if isinstance(modes, Configuration) else modes


def _drives(study: DescribesStudy, angles: Mapping[str, bool]) -> dict[str, dict[str, Any]]:
    """Return values and rates by driver."""
    found: dict[str, dict[str, Any]] = {}
    for word in (VALUES, *RATES):
        given = by_name(study.mechanism, getattr(study, word, None))
        for name, value in (given or {}).items():
            found.setdefault(name, {})[word] = _WRITE[word](value, angles[name])
    return found


VALUES, *RATES = ("values", *OF_DRIVERS[1:])
_WRITE: dict[str, Any] = {
    VALUES: exact_numbers.values,
    **dict.fromkeys(RATES, lambda value, _: exact_numbers.plain(value)),
    RATES[0]: exact_numbers.rate,
}
_NUMBER: dict[str, Any] = {"type": "number"}
_PLACE = {"anyOf": [FRAGMENTS["angle"], FRAGMENTS["point"]]}
_NUMBERS = {"type": "array", "items": _NUMBER}
_WHOLE = {"type": "object", "additionalProperties": {"type": "integer"}, "minProperties": 1}


def study_schema() -> dict[str, Any]:
    """Return the JSON Schema (2020-12) that every study file, TOML or JSON, fits.

    >>> study_schema()["required"]
    ['format', 'mechanism', 'dimensions', 'outputs']
    """
    whole = schema()
    definitions = whole.pop("$defs")
    return {
        "$schema": DIALECT,
        "title": "compoundkin study file",
        "description": "Many designs of a mechanism: what its dimensions may be, and what is found of each.",
        "type": "object",
        "properties": {
            FORMAT: {"enum": list(FORMATS), "description": FORMAT_DOC},
            **{name: {**form, "description": OTHERS[name]} for name, form in _forms().items()},
            **closed_table(HEAD)["properties"],
        },
        "required": [FORMAT, MECHANISM, DIMENSIONS, *(key.name for key in HEAD if key.required)],
        "additionalProperties": False,
        "$defs": {**definitions, MECHANISM: {k: v for k, v in whole.items() if k != "$schema"}},
    }


def _forms() -> dict[str, Any]:
    return {
        MECHANISM: {"anyOf": [FRAGMENTS["name"], {"$ref": f"#/$defs/{MECHANISM}"}]},
        DIMENSIONS: {"anyOf": [_by_name({"anyOf": [_variation(*one) for one in _VARIATIONS]}), FRAGMENTS["name"]]},
        SAMPLE: {"anyOf": [{"enum": list(SAMPLES)}, _WHOLE]},
        MODES: {"anyOf": [FRAGMENTS["name"], _WHOLE]},
        DRIVES: _by_name(closed_table(DRIVEN)),
    }


def _by_name(entry: dict[str, Any]) -> dict[str, Any]:
    return {"type": "object", "additionalProperties": entry, "minProperties": 1}


# Required and optional keys of each kind of variation.
_VARIATIONS: tuple[tuple[dict[str, Any], dict[str, Any]], ...] = (
    ({"low": _PLACE, "high": _PLACE}, {}),
    ({"centre": _PLACE, "within": _PLACE}, {"sigmas": _NUMBER}),
    ({"values": {"anyOf": [FRAGMENTS["angle"], {"type": "array", "items": FRAGMENTS["point"]}]}}, {}),
    (
        {"distribution": FRAGMENTS["name"]},
        {"shape": _NUMBERS, "loc": _PLACE, "scale": _PLACE},
    ),
)


def _variation(needed: dict[str, Any], more: dict[str, Any]) -> dict[str, Any]:
    return {
        "type": "object",
        "properties": {**needed, **more},
        "required": list(needed),
        "additionalProperties": False,
    }


FORMATS = (1,)
FORMAT_DOC = f"The version of this file format; known: {', '.join(map(str, FORMATS))}."
FORMAT, MECHANISM, DIMENSIONS, DRIVES, MODES = "format", "mechanism", "dimensions", "drives", "modes"
OUTPUTS, SAMPLE, COUNT, SEED, TIME = "outputs", "sample", "count", "seed", "time"
HEAD = (
    Key(OUTPUTS, "names", 'What is found of each design, such as "ram.stroke" or "G.position".', required=True),
    Key(COUNT, "whole", "How many designs."),
    Key(SEED, "whole", "Makes random samples repeatable.", default=0),
    Key(TIME, "times", "The times in seconds at which drivers with laws are solved."),
)
# Keys with rules of their own.
OTHERS = {
    MECHANISM: "The path of its file, seen from this one; the name of a shipped mechanism; or its whole document.",
    DIMENSIONS: 'What each dimension may be, by its name in quotes: "crank.B" = { low = 40, high = 60 }; '
    "or the path of a CSV or Parquet table of designs.",
    DRIVES: "What drivers do, by name; the mechanism's own motion where they are left out.",
    MODES: "The assembly modes by links, 1 or -1; or the name of a configuration.",
    SAMPLE: f"Which designs: {', '.join(SAMPLES)}; or the number of levels of each dimension.",
}
# Values and rates of drivers, as in mechanism files.
DRIVEN = tuple(key for key in Drive.keys if key.name in (VALUES, *RATES))
# Keys of variations in the unit of the dimension, degrees for an angle.
WITH_UNIT = ("low", "high", "centre", "within", "values", "loc", "scale")
_HOW = "write { low = 40, high = 60 }, { centre = 50, within = 0.1 } or { values = [40, 50, 60] }"


def variation_data(raw: Any, where: str, is_angle: bool | None, log: Recovery) -> dict[str, Any] | None:
    """Return the plain numbers of a variation, radians. None where the entry is broken, which is reported.

    `is_angle` is None where the mechanism is broken.
    """
    if not isinstance(raw, dict):
        log.report(wrong(where, raw, "a table", _HOW))
        return None
    before = len(log.problems)
    found = {}
    for key, value in raw.items():
        try:
            found[key] = _plain(value, f"{where}.{key}", is_angle) if key in WITH_UNIT else value
        except InvalidMechanism as error:
            log.report(error)
    return found if len(log.problems) == before else None


def variation_entry(data: Mapping[str, Any], is_angle: bool) -> dict[str, Any]:
    """Return the entry of a variation in a file.

    >>> variation_entry({"low": 0.0, "high": np.deg2rad(30.0)}, True)
    {'low': 0, 'high': 30}
    """
    return {key: _in_degrees(value, is_angle and key in WITH_UNIT) for key, value in data.items()}


def _plain(value: Any, where: str, is_angle: bool | None) -> Any:
    """Return numbers and points as plain lists."""
    if isinstance(value, dict) and "polar" in value:
        found = place(value, where)
        return [found.real, found.imag]
    if isinstance(value, list) and any(isinstance(one, dict) for one in value):
        whole = [_plain(one, f"{where}[{index}]", is_angle) for index, one in enumerate(value)]
        return np.asarray(numbers(whole, where)).tolist()
    return np.asarray(coordinate(value, where, is_angle)).tolist()


def _in_degrees(value: Any, is_angle: bool) -> Any:
    if is_angle:
        return exact_numbers.degrees(np.asarray(value, dtype=float))
    if isinstance(value, list | tuple):
        return [_in_degrees(one, False) for one in value]
    return exact_numbers.plain(value) if isinstance(value, float) else value


_ANGLES = ("angle", "turn", "sweep")


def is_angle_dimension(mechanism: Mechanism, driven_angles: Mapping[str, bool], name: str) -> bool:
    """Return whether a dimension is an angle; False for points and unknown names.

    >>> from compoundkin.files import load
    >>> six_bar = load("six-bar")
    >>> [is_angle_dimension(six_bar, {"crank": True}, name) for name in ("slot.angle", "crank.D")]
    [True, False]
    """
    for owner, keys, angles in _owners(mechanism, driven_angles):
        if name.startswith(f"{owner}."):
            word = name.removeprefix(f"{owner}.")
            return any(key.kind in angles and word.split(".")[0] == key.name for key in keys)
    return False


def _owners(
    mechanism: Mechanism, driven_angles: Mapping[str, bool]
) -> Iterator[tuple[str, tuple[Key, ...], tuple[str, ...]]]:
    """Yield the owners of dimensions, their keys, and the kinds of keys that are angles."""
    for drive in mechanism.drives:
        angles = ("coordinate",) if driven_angles.get(drive.name) else ()
        for index, _ in enumerate(getattr(drive.law, SEGMENTS, ())):
            yield f"{drive.name}.{LAW}.{SEGMENTS}.{index}", ProgramSegment.keys, angles
        if drive.law is not None:
            yield f"{drive.name}.{LAW}", drive.law.keys, angles
    for pair in pairs_among(mechanism.items):
        yield pair.name, pair.keys, _ANGLES
    for name, cylinder in mechanism.cylinders.items():
        yield name, cylinder.keys, _ANGLES
