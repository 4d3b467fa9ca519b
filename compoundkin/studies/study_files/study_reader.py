"""From the document of a study file to what `study` is given. All problems are found in one reading."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from compoundkin.base.errors import CompoundkinError, InvalidInput, InvalidMechanism, Problem, suggestion
from compoundkin.files import load
from compoundkin.files.parsed_document import heading
from compoundkin.files.reader import read
from compoundkin.files.recovery import Recovery
from compoundkin.files.shipped_mechanisms import resolve
from compoundkin.files.single_values import bad, described, wrong
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import decompose
from compoundkin.studies.samples.listed_rows import TableSample
from compoundkin.studies.study_files import study_keys as keys
from compoundkin.studies.study_files.dimension_units import is_angle_dimension
from compoundkin.studies.study_files.variation_entries import variation_data
from compoundkin.studies.variations import variation_from, variations_of

# Tables of a single number.
_UNITS = {"rad", "polar"}


def study_arguments(document: Mapping[str, Any], folder: Path, where: str = "") -> dict[str, Any]:
    """Return the arguments of `study` that a document says.

    Paths are seen from a folder. Raises InvalidInput listing all problems.
    """
    log = Recovery({})
    _hold_version(document.get(keys.FORMAT), log)
    known = [keys.FORMAT, *(key.name for key in keys.HEAD), *keys.OTHERS]
    given = {name: value for name, (value, _) in log.recognized(document, known, "").items()}
    head = log.table({key.name: given[key.name] for key in keys.HEAD if key.name in given}, keys.HEAD, "")
    mechanism = _mechanism(given, folder, log)
    angles = decompose(mechanism).driven_angles if mechanism else {}
    found = {
        keys.MECHANISM: mechanism,
        keys.DIMENSIONS: _dimensions(given, mechanism, angles, folder, log),
        **head,
        **_driven(given, mechanism, angles, log),
        **_whole(given, keys.MODES, "an assembly mode", log),
        **_whole(given, keys.SAMPLE, "a number of levels", log),
    }
    if log.problems:
        raise InvalidInput(log.problems, heading=heading(log.problems, where or "study file"))
    return found


def _hold_version(version: Any, log: Recovery) -> None:
    if isinstance(version, bool) or version not in keys.FORMATS:
        what = "it is missing" if version is None else f"{described(version)} is not a known version of the format"
        log.report(bad(keys.FORMAT, what, f"known: {', '.join(f'format = {one}' for one in keys.FORMATS)}"))


def _mechanism(given: Mapping[str, Any], folder: Path, log: Recovery) -> Mechanism | None:
    """Return the mechanism of a path, a name, or a document in the file. None where it is broken."""
    said = given.get(keys.MECHANISM)
    try:
        if isinstance(said, dict):
            return read(said)
        if isinstance(said, str) and said:
            beside = folder / said
            return load(beside if beside.is_file() else resolve(said))
    except CompoundkinError as error:
        own = f"{keys.MECHANISM}." if isinstance(said, dict) else f"{keys.MECHANISM} "
        log.problems += [Problem(f"{own}{one.where}", one.what, one.remedy) for one in error.problems]
        return None
    how = 'write "press.toml", the path of its file, or the name of a shipped mechanism'
    missing = keys.MECHANISM not in given
    log.report(bad(keys.MECHANISM, "it is missing", how) if missing else wrong(keys.MECHANISM, said, "a name", how))
    return None


def _dimensions(
    given: Mapping[str, Any], mechanism: Mechanism | None, angles: Mapping[str, bool], folder: Path, log: Recovery
) -> dict[str, Any]:
    """Return what dimensions may be, by name; those of a table are its columns."""
    found: dict[str, Any] = {}
    if isinstance(path := given.get(keys.DIMENSIONS), str) and path:
        return _columns(folder / path, given, log)
    for name, raw in _table(given, keys.DIMENSIONS, log).items():
        where = f"{keys.DIMENSIONS}.{name}"
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
    if given.get(keys.SAMPLE) != TableSample.word:
        how = f'write {keys.SAMPLE} = "{TableSample.word}"'
        log.report(bad(keys.SAMPLE, "the dimensions are the columns of a table", how))
    try:
        return variations_of(path)
    except InvalidInput as error:
        log.problems += error.problems
        return {}


def _unquoted(raw: Any) -> str:
    """Return the rest of a name that tables were made of, for it is not in quotes."""
    if not isinstance(raw, dict):
        return ""
    inner = next((key for key, one in raw.items() if isinstance(one, dict) and not _UNITS.issuperset(one)), "")
    return ".".join(filter(None, (inner, _unquoted(raw.get(inner)))))


def _driven(
    given: Mapping[str, Any], mechanism: Mechanism | None, angles: Mapping[str, bool], log: Recovery
) -> dict[str, dict[str, Any]]:
    """Return values and rates, each by driver."""
    found: dict[str, dict[str, Any]] = {}
    for name, raw in _table(given, keys.DRIVES, log).items() if keys.DRIVES in given else ():
        where = f"{keys.DRIVES}.{name}"
        if mechanism is not None and name not in angles:
            log.report(bad(where, f"there is no driver {name!r}", suggestion(name, list(angles))))
        for key, value in log.table(raw, keys.DRIVEN, where, angles.get(name)).items():
            found.setdefault(key, {})[name] = value
    return found


def _whole(given: Mapping[str, Any], key: str, what: str, log: Recovery) -> dict[str, Any]:
    """Return what is a text, or whole numbers by names."""
    said = given.get(key)
    if key not in given or (isinstance(said, str) and said):
        return {key: said} if said else {}
    found = _table(given, key, log)
    for name, number in found.items():
        if isinstance(number, bool) or not isinstance(number, int):
            log.report(wrong(f"{key}.{name}", number, what))
    return {key: found}


def _table(given: Mapping[str, Any], name: str, log: Recovery) -> Mapping[str, Any]:
    """Return a table of the file that may not be empty."""
    said = given.get(name)
    if isinstance(said, dict) and said:
        return said
    error: InvalidMechanism = (
        bad(name, "it is missing", keys.OTHERS[name]) if not said else wrong(name, said, "a table", keys.OTHERS[name])
    )
    log.report(error)
    return {}
