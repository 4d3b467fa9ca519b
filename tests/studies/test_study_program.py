"""Rows of a study: the same whoever computes them, and told apart by what each is."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.studies.responses import studied_path
from compoundkin.studies.samples import sample_of
from compoundkin.studies.study_program import StudyProgram
from compoundkin.studies.variations import variation_of

RANGES = {"crank.D.x": variation_of("crank.D.x", (13.0, 14.0)), "plate.C.x": variation_of("plate.C.x", (12.0, 12.5))}
TURN = ck.deg(np.arange(0.0, 360.0, 10.0))


@pytest.fixture(scope="module")
def program() -> StudyProgram:
    names = ["G.position", "bar.angle.stroke", "plate.transmission_angle.least"]
    path, responses = studied_path(ck.catalog.load_named("six-bar"), list(RANGES), names, TURN, speed=3.0)
    return StudyProgram(RANGES, sample_of("sobol", 8192, 1), path, responses)


def test_rows_are_the_same_in_any_chunk(program: StudyProgram) -> None:
    whole = program.rows(range(4000, 4300))
    parts = [program.rows(range(start, start + 100)) for start in range(4000, 4300, 100)]
    assert list(whole) == ["row", *(column.name for column in program.columns)]
    for name, values in whole.items():
        assert np.array_equal(values, np.concatenate([part[name] for part in parts]))
    assert whole["row"].tolist() == list(range(4000, 4300))
    assert not len(program.rows(range(0))["row"])


def test_columns_tell_units_kinds_and_widths(program: StudyProgram) -> None:
    found = {column.name: column for column in program.columns}
    assert found["crank.D.x"].kind == "dimension"
    assert found["G.position.y"].width == len(TURN)
    assert found["bar.angle.stroke"].unit == "rad"
    assert found["reason"].kind == "state"
    assert [found[name].width for name in ("assembled", "bar.angle.stroke")] == [None, None]
    rows = program.rows(range(5))
    assert rows["G.position.x"].shape == (5, len(TURN))
