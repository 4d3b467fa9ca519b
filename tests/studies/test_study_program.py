"""Rows of a study: the same whoever computes them, and told apart by what each is."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.studies.responses import studied_path
from compoundkin.studies.samples import sample_of
from compoundkin.studies.samples.variations import variation_of
from compoundkin.studies.study_program import StudyProgram

RANGES = {"crank.D.x": variation_of("crank.D.x", (13.0, 14.0)), "plate.C.x": variation_of("plate.C.x", (12.0, 12.5))}
TURN = ck.deg(np.arange(0.0, 360.0, 10.0))


@pytest.fixture(scope="module")
def program() -> StudyProgram:
    names = ["G.position", "bar.angle.stroke", "plate.transmission_angle.least"]
    path, responses = studied_path(ck.load("six-bar"), list(RANGES), names, TURN, speed=3.0)
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


def test_designs_are_lost_between_the_poses_as_grashof_tells() -> None:
    """A crank that turns fully has the longest distance to cover at 184 degrees, between two poses."""
    turned = np.deg2rad(4.0)
    four_bar = ck.Mechanism(
        "Four-bar", ck.link("frame", A=0, D=5.0 * np.exp(1j * turned)), ck.link("crank", A=0, B=2),
        ck.link("coupler", B=0, C=5), ck.link("rocker", D=0, C=4), ck.drive("crank"), ck.mode(-1, "rocker"),
    )  # fmt: skip
    ranges = {"crank.B.x": (1.5, 4.5), "coupler.C.x": (3.0, 6.0), "rocker.C.x": (2.5, 5.0)}
    variations = {name: variation_of(name, given) for name, given in ranges.items()}
    path, responses = studied_path(four_bar, list(ranges), ["C.position"], TURN)
    rows = StudyProgram(variations, sample_of("sobol", 2**13, 1), path, responses).rows(range(2**13))
    crank, coupler, rocker = (rows[name] for name in ranges)
    longest, shortest = crank + 5.0 <= coupler + rocker, abs(5.0 - crank) >= abs(coupler - rocker)
    assert np.array_equal(rows["assembled"], longest & shortest)
    told = rows["reason"][~rows["assembled"]]
    assert all(text.startswith("RRR(coupler) cannot be assembled ") for text in told)
    assert "RRR(coupler) cannot be assembled between crank 180 and 190 deg" in told
    assert "RRR(coupler) cannot be assembled at crank 180 to 190 deg" in told
    assert set(rows["circuit"][~rows["assembled"]]) == {"RRR(coupler)+-"}
    assert set(rows["circuit"][rows["assembled"]]) == set(rows["branch"]) == {"RRR(coupler)-"}
    assert not rows["order_defect"].any()
    assert all(text is None for text in rows["reason"][rows["assembled"]])
