"""Compact data of a live page: tables of operations packed, and left out what the page's program computes by itself."""

from __future__ import annotations

from base64 import b64decode, b64encode
from collections.abc import Mapping, Sequence
from math import isfinite
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.programs.page_program import CODES, OperationTable
from compoundkin.view.page.live.live_assets import is_live

# What is written of a link at every pose.
OF_POSES = ("x", "y", "angle", "v", "a")
# What often goes on by equal steps.
STEPPED = ("indices", "along", "drivers")
# Directions that differ by less are one: rates have seven digits.
SAME_DIRECTION = 1e-4
# Whole numbers up to this are written in two bytes.
TWO_BYTES = 2**15


def compact(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the data of a motion for a script, without what a live page's program computes.

    >>> compact({"live": None, "links": []})
    {'live': None, 'links': []}
    """
    if not is_live(data):
        return dict(data)
    program = data["live"]["program"]
    links = [
        _without_keys(link, OF_POSES) if computed["own"] else link
        for link, computed in zip(data["links"], program["links"], strict=True)
    ]
    own = {one["name"] for one in program["outputs"] if one["own"]}
    outputs = [{**one, "parts": dict.fromkeys(one["parts"])} if one["name"] in own else one for one in data["outputs"]]
    found = {**data, "links": links, "outputs": outputs, "centres": [_centre(data, one) for one in data["centres"]]}
    stepped = {key: _stepped(data[key], data["poses"]) for key in STEPPED}
    return {**found, **stepped}


def _stepped(value: Any, poses: int) -> Any:
    """Return data in which numbers with equal steps are the first one and the step."""
    if isinstance(value, Mapping):
        return {key: _stepped(one, poses) for key, one in value.items()}
    if isinstance(value, list):
        return [_stepped(one, poses) for one in value]
    if not isinstance(value, str) or not value.startswith("d:"):
        return value
    numbers = unpacked(value, poses)
    first, step = float(numbers[0]), float(numbers[1] - numbers[0])
    return f"r:{first!r},{step!r}" if np.array_equal(first + step * np.arange(poses), numbers) else value


def _without_keys(whole: Mapping[str, Any], keys: tuple[str, ...]) -> dict[str, Any]:
    return {key: value for key, value in whole.items() if key not in keys}


def _centre(data: Mapping[str, Any], centre: Mapping[str, Any]) -> dict[str, Any]:
    """Return an instant centre without its places, where these follow from velocities at every pose."""
    links = {link["name"]: link for link in data["links"]}
    # what leads a point is no link of the page
    if any("v" not in links.get(name, ()) for name in centre["links"]):
        return dict(centre)
    one, other = (_rate(links[name], data["poses"]) for name in centre["links"])
    ax, ay, w = other - one
    found = np.stack([-ay, ax, w]) * _weights(data)
    known = np.stack([unpacked(part, data["poses"]) for part in centre["at"]]) * _weights(data)
    with np.errstate(all="ignore"):
        found, known = found / np.linalg.norm(found, axis=0), known / np.linalg.norm(known, axis=0)
        apart = np.minimum(np.abs(found - known), np.abs(found + known)).max(axis=0)
    follows = bool(np.all(apart[unpacked(data["assembled"], data["poses"]) == 1.0] < SAME_DIRECTION))
    return _without_keys(centre, ("at",)) if follows else dict(centre)


def _rate(link: Mapping[str, Any], poses: int) -> Number:
    """Return the velocity at the origin and the angular velocity."""
    x, y = (unpacked(link[key], poses) for key in ("x", "y"))
    vx, vy, w = (unpacked(part, poses) for part in link["v"])
    return np.stack([vx + w * y, vy - w * x, w])


def _weights(data: Mapping[str, Any]) -> Number:
    """Lengths in parts of the size."""
    size = data["live"]["size"]
    return np.array([[1.0 / size], [1.0 / size], [1.0]])


def unpacked(text: str | float | None, poses: int) -> Number:
    """Return numbers as they were packed.

    >>> unpacked(3.0, 2)
    array([3., 3.])
    """
    if not isinstance(text, str):
        return np.full(poses, np.nan if text is None else text)
    form = "<f8" if text.startswith("d:") else "<f4"
    return np.frombuffer(b64decode(text[2:]), form).astype(float)


def table_data(table: OperationTable) -> dict[str, Any]:
    """Return a table as the script machine.js takes it."""
    return {
        "codes": list(CODES),
        "constants": list(map(_number, table.constants)),
        "numbers": table.numbers,
        "rows": table.rows,
        "before": packed_integers(table.before),
        "along": packed_integers(table.along),
    }


def _number(value: float) -> float | str:
    """Return a number as JSON has it; what is not finite as a text that a script reads."""
    return value if isfinite(value) else str(value).replace("inf", "Infinity").replace("nan", "NaN")


def packed_integers(numbers: Sequence[int]) -> str:
    """Pack whole numbers, two bytes each where these are enough, else four.

    >>> packed_integers([1, -2])
    'h:AQD+/w=='
    """
    form, mark = ("<i2", "h:") if max(map(abs, numbers), default=0) < TWO_BYTES else ("<i4", "i:")
    return mark + b64encode(np.array(numbers, form).tobytes()).decode("ascii")
