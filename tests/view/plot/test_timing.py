"""Timing charts: phases by hand, rows of drivers and cams, what there is nothing to draw of."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

pytest.importorskip("matplotlib")

import compoundkin as ck
from compoundkin.cli import cli
from compoundkin.errors import InvalidInput, InvalidMechanism
from compoundkin.laws import constant_speed, dwell, fall, least_time, program, rise, time_table
from compoundkin.view.plot.timing_chart import timing_rows


def phases(what: Any, over: str | None = None) -> dict[str, list[tuple[str, float, float]]]:
    _, found = timing_rows(what, over)
    return {row.name: [(p.word, round(p.begin, 6), round(p.end, 6)) for p in row.phases] for row in found}


def test_phases_are_those_of_the_laws() -> None:
    laws = {
        "clamp": program(rise(12, 1), rise(3, 1, "4-5-6-7"), dwell(2), fall(15, 1, "modified-sine")),
        "index": program(rise(1, 0.5, "parabolic"), dwell(1.5), repeat=True),
        "feed": least_time(-20.0, acceleration=80.0),
        "drum": constant_speed(-2.0),
        "spindle": lambda t: np.where(t < np.pi, 0.0, 1.0 - np.cos(t - np.pi)),
        "table": time_table([1, 2, 3], [0, 1, 0]),
    }
    assert phases(laws) == {
        "clamp": [("rise", 0, 2), ("dwell", 2, 4), ("fall", 4, 5)],
        "index": [("rise", 0, 0.5), ("dwell", 0.5, 2), ("rise", 2, 2.5), ("dwell", 2.5, 4), ("rise", 4, 4.5),
                  ("dwell", 4.5, 5)],
        "feed": [("fall", 0, 1), ("dwell", 1, 5)],
        "drum": [("fall", 0, 5)],
        "spindle": [("dwell", 0, pytest.approx(np.pi, abs=1e-4)), ("rise", pytest.approx(np.pi, abs=1e-4), 5)],
        "table": [("rise", 1, 2), ("fall", 2, 3)],
    }  # fmt: skip


def cam(**more: Any) -> ck.Mechanism:
    turn = 2 * np.pi
    lift = program(rise(20, turn / 4), dwell(turn / 4), fall(20, turn / 4), dwell(turn / 4))
    return ck.Mechanism(
        "Cam", ck.link("frame", A=0), ck.link("disc", A=0), ck.link("follower", P=0),
        ck.slide("follower", on="frame", through="A", angle=ck.deg(90)),
        ck.cam("follower", on="disc", at="P", profile=ck.profiles.synthesise(lift, base=40, **more)), ck.drive("disc"),
        unit="mm",
    )  # fmt: skip


@pytest.mark.parametrize("more", [{"start": ck.deg(30)}, {"start": ck.deg(-30), "clockwise": True}])
def test_cams_are_laid_over_a_turn_from_where_their_program_begins(more: dict[str, Any]) -> None:
    expected = [("dwell", 0, 30), ("rise", 30, 120), ("dwell", 120, 210), ("fall", 210, 300), ("dwell", 300, 360)]
    assert phases(cam(**more)) == {"follower/disc": expected}
    (row,) = timing_rows(cam(**more), None)[1]
    # the disc itself, at as much rotation in its sense
    motion = ck.solve(cam(**more), {"disc": np.deg2rad([0.0, 75.0, 130.0]) * (-1 if more.get("clockwise") else 1)})
    heights = motion.points["P"].position.imag - 40.0
    np.testing.assert_allclose(row.moved(np.array([0.0, 75.0, 130.0]))[0], heights, atol=1e-9)
    np.testing.assert_allclose(heights, [0.0, 10.0, 20.0], atol=1e-9)


def arm(law: Any, **more: Any) -> ck.Mechanism:
    return ck.Mechanism("Arm", ck.link("frame", A=0), ck.link("arm", A=0, B=1), ck.drive("arm", law=law), **more)


def test_the_chart_of_a_mechanism_has_its_units_title_and_times(tmp_path: Path) -> None:
    law = program(rise(ck.deg(90), 1), dwell(1))
    picture = ck.plots.timing_chart(arm(law, time=np.linspace(0, 4, 9)))
    (axes,) = picture.figure.axes
    assert axes.get_ylabel() == "arm\n[°]"
    assert axes.get_xlim() == (0.0, 4.0)
    assert [text.get_text() for text in axes.texts[:2]] == ["rise 1 s", "dwell 3 s"]
    np.testing.assert_allclose(axes.get_yticks(), [0.0, 90.0])
    assert picture.figure.get_suptitle() == "Arm"
    steps = program(rise(2, law="least-time", speed=2, acceleration=3, jerk=9), rise(1, over=1))
    (axes,) = ck.plots.timing_chart({"steps": steps}).figure.axes
    np.testing.assert_allclose(axes.get_yticks(), [0.0, 2.0, 3.0])
    picture.save(tmp_path / "chart.pdf")
    turned = ck.plots.timing_chart({"lift": program(rise(20, np.pi), fall(20, np.pi))}, over="rotation", title="Lift")
    assert turned.figure.axes[0].get_xlabel() == "rotation of the cam [°]"


@pytest.mark.parametrize(
    ("what", "over", "words"),
    [
        (arm(None), None, "no driver has a law and no cam"),
        (arm(constant_speed(2.0)), None, "the time over which"),
        (arm(constant_speed(2.0)), "rotation", "no cam is made"),
        (cam(), "time", "no driver has a law"),
        ({}, None, "there is no law"),
        ({"a": None}, None, "not a law"),
        ({"a": constant_speed(2.0)}, "rotation", "not a motion program"),
        ({"a": program(rise(20, 90), fall(20, 270))}, "rotation", r"laws\.a: the spans add up to 20626.5 degrees"),
        ({"a": constant_speed([[1.0], [2.0]]), "b": program(dwell(1))}, None, "several designs"),
    ],
)
def test_where_there_is_nothing_to_draw_it_says_so(what: Any, over: Any, words: str) -> None:
    with pytest.raises((InvalidInput, InvalidMechanism), match=words):
        ck.plots.timing_chart(what, over=over)


def test_the_command_draws_it_and_refuses_what_does_not_fit(tmp_path: Path) -> None:
    path = tmp_path / "chart.svg"
    done = CliRunner().invoke(cli, ["plot", "disc-cam-roller-program", "--timing", "-o", str(path)])
    assert done.exit_code == 0
    assert path.read_bytes().startswith(b"<?xml")
    for more in (["--from", "3"], ["--step", "2"], ["G.x"], ["--every", "3"], ["--path"]):
        refused = CliRunner().invoke(cli, ["plot", "disc-cam-roller-program", "--timing", *more])
        assert refused.exit_code != 0
