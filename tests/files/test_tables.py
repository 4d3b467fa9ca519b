"""A motion as a flat table, the same in every format and from both sides: Python and the command line."""

from __future__ import annotations

import csv
import json
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from compoundkin.base.errors import InvalidInput, UnassembledPoses, UnknownName
from compoundkin.base.suffixes import SUFFIXES
from compoundkin.cli import cli
from compoundkin.files import load
from compoundkin.files.saved_files import save
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
    table = motion.table()
    assert np.array_equal(table["G.velocity.y"].values, np.asarray(motion.points["G"].velocity).imag)
    assert np.array_equal(table["bar.angular_acceleration"].values, motion.links["bar"].angular_acceleration)
    assert np.array_equal(table["block/bar.rate"].values, motion.pairs["block/bar"].rate)
    assert np.array_equal(table["crank.value"].values, motion.drives["crank"].value)
    assert table["assembled"].values.all()
    assert not {"frame.angle", "design", "G.jerk.x"} & set(table.names)
    assert {column.values.shape for column in table.columns} == {motion.shape}
    with pytest.raises(UnknownName, match=r"did you mean 'G\.velocity\.y'"):
        table["G.velocity.yy"]


def test_orders_are_those_solved_for(designs: Motion) -> None:
    assert [name for name in designs.table().names if name.startswith("B.")] == ["B.position.x", "B.position.y"]
    third = solve(load(SIX_BAR), {"crank": [0.0, 0.1]}, order=3).table()
    assert {"G.jerk.x", "bar.angular_jerk", "crank.jerk", "block/bar.third"} <= set(third.names)


def test_chosen_quantities_stand_beside_what_tells_the_poses(designs: Motion, motion: Motion) -> None:
    assert designs.table("B.x", "B").names == ("design", "crank.value", "B.x", "B.y", "assembled")
    found = motion.table("G.velocity", "G.velocity.length", "crank.value", "bar")
    assert found.names[:4] == ("crank.value", "G.velocity.x", "G.velocity.y", "G.velocity.length")
    assert np.array_equal(found["G.velocity.length"].values, motion.points["G"].speed)
    timed = solve(load(SIX_BAR), {"crank": 0.0}, time=[0.0, 0.1]).table("bar")
    assert timed.names == ("time", "crank.value", "bar", "assembled")
    assert timed.units == {"time": "s", "crank.value": "rad", "bar": "rad"}


def test_designs_have_index_columns(designs: Motion) -> None:
    table = designs.table()
    assert table["design"].values.tolist() == [0, 0, 0, 1, 1, 1]
    assert table["crank.value"].values.tolist() == [0.0, 0.5, 1.0] * 2
    assert table["B.position.x"].values[3] == 2.0


def test_several_axes_of_designs_and_a_single_pose() -> None:
    crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    table = solve(crank, {"crank": np.zeros((2, 3, 4))}, order=0).table()
    assert table.names[:2] == ("design0", "design1")
    assert len(table["design1"].values) == len(table) == 24
    assert solve(crank, {"crank": 0.0}).table()["crank.speed"].values.shape == (1,)


def test_units_follow_the_quantity(motion: Motion) -> None:
    unit = motion.table().shown.units
    assert unit["G.acceleration.x"] == "mm/s^2"
    assert unit["bar.angle"] == "deg"
    assert unit["bar.angular_velocity"] == "rad/s"
    assert unit["block/bar.value"] == "mm"
    assert motion.table().units["crank.value"] == "rad"


def test_csv_has_units_degrees_and_every_digit(motion: Motion, tmp_path: Path) -> None:
    save(motion, tmp_path / "m.csv")
    with (tmp_path / "m.csv").open(newline="") as file:
        head, *rows = csv.reader(file)
    assert "crank.value [deg]" in head
    assert "G.velocity.x [mm/s]" in head
    assert [row[0] for row in rows[:3]] == ["0.0", "5.0", "10.0"]
    place = head.index("G.velocity.x [mm/s]")
    assert [float(row[place]) for row in rows] == motion.table()["G.velocity.x"].values.tolist()


def test_json_has_units_degrees_and_null_where_nothing_is_assembled(tmp_path: Path) -> None:
    bars = link("frame", A=0, D=4), link("crank", A=0, B=3), link("coupler", B=0, C=3), link("rocker", D=0, C=3)
    with pytest.warns(UnassembledPoses):
        open_ = solve(Mechanism("m", *bars, drive("crank")), {"crank": np.deg2rad([30.0, 180.0])}, order=0)
    save(open_, tmp_path / "m.json")
    columns = {column["name"]: column for column in json.loads((tmp_path / "m.json").read_text())["columns"]}
    assert columns["crank.value"]["unit"] == "deg"
    np.testing.assert_allclose(columns["crank.value"]["values"], [30.0, 180.0], rtol=1e-15)
    assert columns["assembled"]["values"] == [True, False]
    assert columns["rocker.angle"]["values"][0] is not None
    assert columns["rocker.angle"]["values"][1] is None


def test_npz_and_parquet_hold_the_columns_their_units_and_how_angles_are_counted(
    motion: Motion, tmp_path: Path
) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    for suffix in (".npz", ".parquet"):
        save(motion, tmp_path / f"m{suffix}")
    read = parquet.read_table(tmp_path / "m.parquet")
    table = motion.table()
    with np.load(tmp_path / "m.npz") as stored:
        for column in table.columns:
            assert np.array_equal(stored[column.name], column.values)
            assert np.array_equal(read[column.name].to_numpy(), column.values)
        assert json.loads(str(stored["units"])) == table.units
        assert str(stored["angles"]) == "radians"
        assert set(stored.files) - {"units", "angles", "title"} == set(table.names)
    assert read.schema.field("bar.angle").metadata == {b"unit": b"rad"}
    assert read.schema.field("G.velocity.x").metadata == {b"unit": b"mm/s"}
    assert read.schema.metadata[b"angles"] == b"radians"
    assert read.schema.metadata[b"title"].decode() == motion.mechanism.title


def test_pandas_holds_the_columns(designs: Motion) -> None:
    pytest.importorskip("pandas")
    frame = designs.to_pandas()
    assert tuple(frame.columns) == designs.table().names
    assert frame["assembled"].dtype == bool
    assert frame.attrs["angles"] == "radians"
    assert frame.attrs["units"]["crank.value"] == "rad"
    assert tuple(designs.to_pandas("B.x").columns) == ("design", "crank.value", "B.x", "assembled")


def test_what_is_not_installed_is_named(motion: Motion, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(InvalidInput, match=r"pip install 'compoundkin\[parquet\]'"):
        save(motion, tmp_path / "m.parquet")
    with pytest.raises(InvalidInput, match=r"pip install 'compoundkin\[pandas\]'"):
        motion.to_pandas()
    assert list(tmp_path.iterdir()) == []


def test_a_table_shows_itself_in_a_line(motion: Motion) -> None:
    assert repr(motion.table("G.velocity")) == "Table('Six-bar of Example 3-4': 73 rows of 4 columns)"


@pytest.mark.parametrize("suffix", SUFFIXES["table"])
def test_python_and_the_command_line_write_the_same_files(suffix: str, tmp_path: Path) -> None:
    ours, theirs = tmp_path / f"ours{suffix}", tmp_path / f"theirs{suffix}"
    save(solve(load(SIX_BAR)), ours)
    result = CliRunner().invoke(cli, ["solve", str(SIX_BAR), "-o", str(theirs)], catch_exceptions=False)
    assert result.exit_code == 0
    assert ours.read_bytes() == theirs.read_bytes()
