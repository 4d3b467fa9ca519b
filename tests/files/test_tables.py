"""A motion as a flat table, the same in every format."""

from __future__ import annotations

import csv
import sys
from pathlib import Path

import numpy as np
import pytest

from compoundkin.base.errors import InvalidInput
from compoundkin.files import columns, load, motion_tables, save_table, to_pandas
from compoundkin.kinematics import Motion, solve
from compoundkin.model.elements import drive, link
from compoundkin.model.mechanism import Mechanism

SIX_BAR = Path(__file__).parent / "samples" / "six-bar.toml"


@pytest.fixture
def motion() -> Motion:
    return solve(load(SIX_BAR))


@pytest.fixture
def designs() -> Motion:
    crank = Mechanism("m", link("frame", A=0), link("crank", A=([[0.0], [-1.0]], 0), B=1), drive("crank"))
    return solve(crank, {"crank": [0.0, 0.5, 1.0]}, order=0)


def test_columns_are_the_motion(motion: Motion) -> None:
    table = columns(motion)
    assert np.array_equal(table["G.velocity.y"], np.asarray(motion.points["G"].velocity).imag)
    assert np.array_equal(table["bar.angular_acceleration"], motion.links["bar"].angular_acceleration)
    assert np.array_equal(table["block/bar.rate"], motion.pairs["block/bar"].rate)
    assert np.array_equal(table["crank.value"], motion.drives["crank"].value)
    assert table["assembled"].all()
    assert not {"frame.angle", "design", "G.jerk.x"} & table.keys()
    assert {values.shape for values in table.values()} == {motion.shape}


def test_orders_are_those_solved_for(designs: Motion) -> None:
    assert [name for name in columns(designs) if name.startswith("B.")] == ["B.position.x", "B.position.y"]
    third = columns(solve(load(SIX_BAR), {"crank": [0.0, 0.1]}, order=3))
    assert {"G.jerk.x", "bar.angular_jerk", "crank.jerk", "block/bar.third"} <= third.keys()


def test_designs_have_index_columns(designs: Motion) -> None:
    table = columns(designs)
    assert table["design"].tolist() == [0, 0, 0, 1, 1, 1]
    assert table["crank.value"].tolist() == [0.0, 0.5, 1.0] * 2
    assert table["B.position.x"][3] == 2.0


def test_several_axes_of_designs_and_a_single_pose() -> None:
    crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    table = columns(solve(crank, {"crank": np.zeros((2, 3, 4))}, order=0))
    assert list(table)[:2] == ["design0", "design1"]
    assert len(table["design1"]) == 24
    assert columns(solve(crank, {"crank": 0.0}))["crank.speed"].shape == (1,)


def test_units_follow_the_quantity(motion: Motion) -> None:
    unit = motion_tables.units(motion, degrees=True)
    assert unit["G.acceleration.x"] == "mm/s^2"
    assert unit["bar.angle"] == "deg"
    assert unit["bar.angular_velocity"] == "rad/s"
    assert unit["block/bar.value"] == "mm"
    assert motion_tables.units(motion)["crank.value"] == "rad"


def test_csv_has_units_degrees_and_every_digit(motion: Motion, tmp_path: Path) -> None:
    save_table(motion, tmp_path / "m.csv")
    with (tmp_path / "m.csv").open(newline="") as file:
        head, *rows = csv.reader(file)
    assert "crank.value [deg]" in head
    assert "G.velocity.x [mm/s]" in head
    assert [row[0] for row in rows[:3]] == ["0.0", "5.0", "10.0"]
    place = head.index("G.velocity.x [mm/s]")
    assert [float(row[place]) for row in rows] == columns(motion)["G.velocity.x"].tolist()


def test_npz_and_parquet_hold_the_columns(motion: Motion, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    for suffix in (".npz", ".parquet"):
        save_table(motion, tmp_path / f"m{suffix}")
    read = parquet.read_table(tmp_path / "m.parquet")
    with np.load(tmp_path / "m.npz") as stored:
        for name, values in columns(motion).items():
            assert np.array_equal(stored[name], values)
            assert np.array_equal(read[name].to_numpy(), values)
    assert read.schema.field("bar.angle").metadata == {b"unit": b"rad"}


def test_pandas_holds_the_columns(designs: Motion) -> None:
    pytest.importorskip("pandas")
    frame = to_pandas(designs)
    assert list(frame.columns) == list(columns(designs))
    assert frame["assembled"].dtype == bool


def test_what_is_not_installed_is_named(motion: Motion, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(InvalidInput, match=r"pip install 'compoundkin\[parquet\]'"):
        save_table(motion, tmp_path / "m.parquet")
    with pytest.raises(InvalidInput, match=r"pip install 'compoundkin\[pandas\]'"):
        to_pandas(motion)
    with pytest.raises(InvalidInput, match=r"tables end in \.csv, \.npz, \.parquet"):
        save_table(motion, tmp_path / "m.xlsx")
    assert list(tmp_path.iterdir()) == []
