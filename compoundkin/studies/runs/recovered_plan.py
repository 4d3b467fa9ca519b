"""The study that plain data tell: what a folder is asked for when its program is gone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.studies.runs.study_data import CALLED, ORDER, mechanism_from
from compoundkin.studies.runs.study_plan import ASKED, StudyPlan
from compoundkin.studies.samples import sample_from
from compoundkin.studies.variations import variation_from


def plan_from(data: Mapping[str, Any]) -> StudyPlan:
    """Return the study of which these are the data.

    Raises InvalidInput where a part of it is no data: a function, a configuration without signs.
    """
    if untold := list(_untold(data, "")):
        remedy = "run the study into this folder: what is there is not computed again"
        raise InvalidInput(Problem(f"study.{untold[0]}", "it is an object of a program, which no file holds", remedy))
    named = {name: data["dimensions"][name] for name in data[ORDER]}
    dimensions = {name: variation_from(f"dimensions.{name}", one) for name, one in named.items()}
    sample = sample_from(data["sample"])
    rest: dict[str, Any] = {name: data.get(name) for name in ASKED}
    return StudyPlan(mechanism_from(data["mechanism"]), dimensions, tuple(data["outputs"]), sample, **rest)


def _untold(data: Any, where: str) -> Iterator[str]:
    """Yield the places of what the data only name."""
    if isinstance(data, Mapping):
        if CALLED in data:
            yield where
        for key, one in data.items():
            yield from _untold(one, f"{where}.{key}" if where else key)
