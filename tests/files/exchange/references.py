"""The samples of other programs' files with their numbers, and how a mechanism is held against them."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import compoundkin as ck
from compoundkin.files.exchange.posed_mechanism import PosedMechanism, posed_mechanism

_FILE = Path(__file__).parents[2] / "reference" / "formats.json"
# How far a place may be from its published number, as a part of the size, where the sample does not say.
TOLERANCE = 1e-9


@cache
def _all() -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(_FILE.read_text(encoding="utf-8"))
    return found


def entry(name: str) -> dict[str, Any]:
    return next(one for one in _all() if one["id"] == name)


def entries(form: str) -> list[dict[str, Any]]:
    """The samples of a format that are to be read."""
    return [one for one in _all() if one["format"] == form and "text" in one]


def letter_at(shown: PosedMechanism, place: complex, tolerance: float, name: str = "") -> str:
    """The point that is drawn at a place: samples and readers need not agree on letters.

    Of several that of this name, or else the one of most moving links: guides may have a point of their own there.
    """
    carriers = shown.mechanism.carriers
    found = [k for k, links in carriers.items() if abs(shown.place(links[0], k) - place) <= tolerance]
    assert found, f"no point is drawn at {place}"
    return max(found, key=lambda k: (k == name, len({*carriers[k]} - {"frame"})))


def driven_by(shown: PosedMechanism, change: float) -> dict[str, Any]:
    """Values of the only driver, from the pose as drawn to one so much on: wheels count their turns from there."""
    (name,) = shown.values
    return {name: shown.values[name] + change * np.linspace(0.0, 1.0, 13)}


def holds(mechanism: ck.Mechanism, sample: dict[str, Any]) -> None:
    """Compare positions at driver values counted from the pose as drawn with those of a sample."""
    expected = sample["expected"]
    kind = next((k for k in expected if k.startswith("positions_by_")), None)
    assert kind is not None
    size = mechanism.geometry.size
    tolerance = sample.get("tolerance", TOLERANCE * size)
    shown = posed_mechanism(mechanism)
    rows = {float(key): row for key, row in expected[kind].items()}
    first = rows.get(0.0)
    letters = {
        name: letter_at(shown, complex(*place), 10 * tolerance, name) for name, place in (first or {}).items()
    } or {name: name for name in next(iter(rows.values()))}
    for change, row in rows.items():
        step = change if "extension" in kind else np.deg2rad(change)
        motion = ck.solve(mechanism, driven_by(shown, step), order=0)
        for name, place in row.items():
            found = complex(np.ravel(motion.points[letters[name]].position)[-1])
            assert abs(found - complex(*place)) <= tolerance, (sample["id"], change, name, found, place)
