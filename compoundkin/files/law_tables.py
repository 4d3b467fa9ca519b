"""Tables of laws, paths, profiles, programs of cams and amounts of loads, read and written.

Each is read with problems of its own. Most files have none of them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from compoundkin.base.errors import InvalidInput, InvalidMechanism, Problem, suggestion
from compoundkin.files import document as doc
from compoundkin.files import exact_numbers
from compoundkin.files.document import DWELL, KIND, PROGRAM
from compoundkin.files.read_values import bad, described, numbers, point, wrong
from compoundkin.files.recovery import Recovery, Tagged, wide_disc
from compoundkin.model import laws, prescribed_paths, profiles
from compoundkin.model.attributes import TIME
from compoundkin.model.fields import Key, Kind
from compoundkin.model.laws import Law
from compoundkin.model.laws.motion_programs import LIMITS, NAMES, Program, ProgramSegment
from compoundkin.model.loads.amounts import LoadFunction, LoadTable
from compoundkin.model.loads.contract import COORDINATE, RATE
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.prescribed_paths import Path
from compoundkin.model.profiles import Profile

RISING = tuple(name for name in NAMES if name != DWELL)
# The spans of a cam's program are of its rotation, and limits are rates by that, in radians.
_OF_CAMS: Mapping[str, Kind] = {"over": "turn", **dict.fromkeys(LIMITS, "number")}
SEGMENT = tuple(replace(key, kind=_OF_CAMS.get(key.name, key.kind)) for key in ProgramSegment.keys)


def law(log: Recovery, raw: Any, where: str, angle: bool | None) -> Law | None:
    """Return the law that a table says. None where it is broken, which is reported."""
    return of_kind(log, "law", laws.WRITTEN, raw, where, angle)


def of_kind(
    log: Recovery, word: str, known: Mapping[str, type[Any]], raw: Any, where: str, angle: bool | None
) -> Any | None:
    """Return an object from a table that says its kind, one of those known.

    None where it is broken, which is reported.
    """
    how = f'write {{ {KIND} = "...", ... }}, the kind one of {", ".join(known)}'
    if not isinstance(raw, dict):
        log.report(wrong(where, raw, f"a {word}", how))
        return None
    kind = raw.get(KIND)
    if not isinstance(kind, str) or kind not in known:
        what = f"there is no {word} {described(kind)}" if KIND in raw else "it is missing"
        log.report(bad(f"{where}.{KIND}", what, suggestion(str(kind), list(known))))
        return None
    entries = {key: value for key, value in raw.items() if key != KIND}
    return made(log, known[kind], entries, where, angle)


def path(log: Recovery, raw: Any, where: str, angle: bool | None) -> Path | None:
    """Return the path that a table says. None where it is broken, which is reported."""
    return of_kind(log, "path", prescribed_paths.WRITTEN, raw, where, False)


def segments(
    log: Recovery, raw: Any, where: str, angle: bool | None, keys: tuple[Key, ...] = ProgramSegment.keys
) -> tuple[ProgramSegment, ...]:
    """Return the segments of a program. Those that are broken are left out, which is reported."""
    if not isinstance(raw, list):
        log.report(wrong(where, raw, "a list of segments", 'write [{ law = "cycloidal", over = 1, rise = 90 }]'))
        return ()
    found = [made(log, ProgramSegment, table, f"{where}[{index}]", angle, keys) for index, table in enumerate(raw)]
    for index, table in enumerate(raw):
        if isinstance(table, dict) and "rise" not in table and table.get("law") in RISING:
            log.report(bad(f"{where}[{index}].rise", "it is missing", f'write rise = 30, or law = "{DWELL}"'))
    return tuple(segment for segment in found if segment is not None)


def profile(log: Recovery, raw: Any, where: str, angle: bool | None) -> Profile:
    """Return the profile that a table says. A disc where it is broken, which is reported.

    Where the follower turns about a pivot, the rises of its program are angles.
    """
    found: Profile | None = of_kind(
        log, "profile", profiles.WRITTEN, raw, where, isinstance(raw, dict) and "pivot" in raw
    )
    return wide_disc() if found is None else found


def program(log: Recovery, raw: Any, where: str, angle: bool | None) -> Program | None:
    """Return a program over a turn of a cam. Its segments alone, or a table that also says where it starts."""
    table = raw if isinstance(raw, dict) else {"segments": raw}
    found: Program | None = made(log, Program, table, where, angle, PROGRAM)
    return found


def turned(log: Recovery, raw: Any, where: str, angle: bool | None) -> tuple[ProgramSegment, ...]:
    """Return the segments of a cam's program."""
    return segments(log, raw, where, angle, SEGMENT)


def made(
    log: Recovery, kind: type[Any], raw: Any, where: str, angle: bool | None, keys: tuple[Key, ...] | None = None
) -> Any:
    """Return an object of a kind from its table. None where the table is broken or what it says cannot be meant."""
    before = len(log.problems)
    found = log.table(raw, kind.keys if keys is None else keys, where, angle)
    if len(log.problems) > before:
        return None
    try:
        return kind(**found)
    except InvalidMechanism as error:
        log.report(InvalidMechanism([_placed(problem, where) for problem in error.problems]))
        return None


def _placed(problem: Problem, where: str) -> Problem:
    """Return a problem of an object, "segment.over", at the place of its table."""
    _, dot, rest = problem.where.partition(".")
    return replace(problem, where=where + dot + rest)


def amount(log: Recovery, raw: Any, where: str, angle: bool | None, over: str = "") -> Any:
    """Return an amount of a load: a number, an array or a table. Zero where it is broken, which is reported."""
    if isinstance(raw, dict):
        told = raw.get("over", over)
        known = {TIME: False, RATE: False, "": angle}
        is_angle = known[told] if isinstance(told, str) and told in known else log.is_angle(str(told))
        table = made(log, LoadTable, {"over": over, **raw}, where, is_angle)
        return 0.0 if table is None else table
    try:
        return numbers(raw, where)
    except InvalidMechanism as error:
        log.report(error)
        return 0.0


def planar(log: Recovery, raw: Any, where: str, angle: bool | None) -> Any:
    """Return a vector of a load.

    It is a point, a table of points, or two amounts, x and y.
    """
    if isinstance(raw, dict) and isinstance(raw.get("values"), list):
        entries = raw["values"]
        if not all(isinstance(entry, list) and len(entry) == 2 for entry in entries):
            log.report(wrong(f"{where}.values", entries, "a list of vectors", "write [[x, y], [x, y]]"))
            return 0j
        raw = [{**raw, "values": [entry[k] for entry in entries]} for k in range(2)]
    if isinstance(raw, list) and len(raw) == 2 and any(isinstance(one, dict) for one in raw):
        return tuple(amount(log, one, f"{where}[{k}]", angle, TIME) for k, one in enumerate(raw))
    try:
        return point(raw, where)
    except InvalidMechanism as error:
        log.report(error)
        return 0j


# What is read table by table, each with its own problems.
READERS: dict[Kind, Tagged] = {
    "law": law,
    "path": path,
    "segments": segments,
    "profile": profile,
    "program": program,
    "turned": turned,
    "planar": planar,
    "amount": amount,
}


def load_table(mechanism: Mechanism, item: Any) -> dict[str, Any]:
    """Return the amounts of a load as a file writes them. Raises InvalidInput for a Python function."""
    own = getattr(item, "own_variable", "") == COORDINATE and doc.name_is_angle(mechanism, item.pair)
    return {key: _amount(mechanism, f"{item.where}.{key}", getattr(item, key), bool(own))
            for key in getattr(item, "amounts", ()) if getattr(item, key) is not None}  # fmt: skip


def _amount(mechanism: Mechanism, where: str, held: Any, own: bool) -> Any:
    if isinstance(held, LoadFunction):
        what = "a Python function cannot be written to a file"
        raise InvalidInput(Problem(where, what, "write a table of its values instead"))
    if isinstance(held, tuple):
        return [_amount(mechanism, where, part, own) for part in held]
    if isinstance(held, LoadTable):
        return _table(
            held, {"": own, TIME: False, RATE: False}.get(held.over, bool(doc.name_is_angle(mechanism, held.over)))
        )
    return (exact_numbers.point if np.iscomplexobj(held) else exact_numbers.plain)(held)


def _table(held: LoadTable, angle: bool) -> dict[str, Any]:
    """Return a table; what it does not say is left out."""
    out: dict[str, Any] = {"over": held.over} if held.over else {}
    out |= {"at": exact_numbers.coordinate(held.at, angle), "values": exact_numbers.plain(held.values)}
    if held.period is not None:
        out["period"] = exact_numbers.coordinate(held.period, angle)
    return {**out, "smooth": True} if held.smooth else out
