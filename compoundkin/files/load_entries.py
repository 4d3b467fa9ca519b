"""Masses and loads of a mechanism file, table by table."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files import document as doc
from compoundkin.files import exact_numbers
from compoundkin.files.recovery import JOINED, Recovery
from compoundkin.files.single_values import wrong
from compoundkin.model.attributes import TIME
from compoundkin.model.elements import Item
from compoundkin.model.loads import WRITTEN as LOADS
from compoundkin.model.loads.amounts import LoadFunction, LoadTable
from compoundkin.model.loads.attachments import COORDINATE
from compoundkin.model.loads.gravity import Gravity, warn_of_unit
from compoundkin.model.mechanism import Mechanism

# The key that tells springs and dampers along pairs from those between points.
_PAIR = "pair"


def written_loads(parts: Mapping[str, Any], log: Recovery, driven: Mechanism | None) -> Iterator[Item]:
    """Yield gravity, masses and loads. `driven` is the mechanism without them, which tells angles from lengths."""
    if driven is not None:
        log.is_angle = partial(doc.name_is_angle, driven)
    given = {key: value for key, value in parts.items() if key == doc.GRAVITY.name}
    for vector in log.table(given, (doc.GRAVITY,), "").values():
        warn_of_unit(vector)
        yield Gravity(vector)
    for name, kinds in LOADS.items():
        for raw, where in tables_of(parts, name, log):
            yield _load(kinds, raw, where, log)


def _load(kinds: tuple[type[Any], ...], raw: Any, where: str, log: Recovery) -> Item:
    """Return a load of the kind that its table is of."""
    pair = raw.get(_PAIR) if isinstance(raw, dict) else None
    kind = next((kind for kind in kinds if any(key.name == _PAIR for key in kind.keys) == (pair is not None)), kinds[0])
    is_own = getattr(kind, "own_variable", "") == COORDINATE
    item: Item = kind(**log.table(raw, kind.keys, where, log.is_angle(str(pair)) if is_own else False))
    return item


def tables_of(parts: Mapping[str, Any], name: str, log: Recovery) -> list[tuple[Any, str]]:
    """Return the tables of an array with their places. A single table is read as an array of one."""
    raw = parts.get(name, [])
    if not isinstance(raw, list):
        log.report(wrong(name, raw, "an array of tables", f"write [[{name}]]"), JOINED)
        raw = [raw] if isinstance(raw, dict) else []
    return [(table, f"{name}[{index}]") for index, table in enumerate(raw)]


def load_table(mechanism: Mechanism, item: Any) -> dict[str, Any]:
    """Return the amounts of a load as a file writes them. Raises InvalidInput for a Python function."""
    own = getattr(item, "own_variable", "") == COORDINATE and doc.name_is_angle(mechanism, item.pair)
    return {key: _amount(mechanism, f"{item.where}.{key}", getattr(item, key), bool(own))
            for key in getattr(item, "amounts", ())}  # fmt: skip


def _amount(mechanism: Mechanism, where: str, held: Any, own: bool) -> Any:
    if isinstance(held, LoadFunction):
        what = "a Python function cannot be written to a file"
        raise InvalidInput(Problem(where, what, "write a table of its values instead"))
    if isinstance(held, tuple):
        return [_amount(mechanism, where, part, own) for part in held]
    if isinstance(held, LoadTable):
        return _table(held, {"": own, TIME: False}.get(held.over, bool(doc.name_is_angle(mechanism, held.over))))
    return (exact_numbers.point if np.iscomplexobj(held) else exact_numbers.plain)(held)


def _table(held: LoadTable, angle: bool) -> dict[str, Any]:
    """Return a table; what it does not say is left out."""
    out: dict[str, Any] = {"over": held.over} if held.over else {}
    out |= {"at": exact_numbers.coordinate(held.at, angle), "values": exact_numbers.plain(held.values)}
    if held.period is not None:
        out["period"] = exact_numbers.coordinate(held.period, angle)
    return {**out, "smooth": True} if held.smooth else out
