"""Driver's laws found from motions asked for the other way round, and driven forward again."""

from __future__ import annotations

import numpy as np
import pytest
from click.testing import CliRunner

import compoundkin as ck
from compoundkin.cli import cli
from compoundkin.files.mechanism_files import dumps, loads
from compoundkin.model.elements import Expectation
from compoundkin.model.prescribed_motion import PrescribedMotion
from tests.catalog import mechanism as loaded
from tests.kinematics.test_led_motions import MIDDLE, RADIUS, SPAN, TIMES, circle, four_bar, redriven

# Quintics between 41 poses of a turn miss it by (2 pi / 40)**6 / 46080 of the amplitude.
BETWEEN = 1e-9


def test_a_five_bar_driven_forward_draws_the_circle_again() -> None:
    led = ck.solve(loaded("five-bar-led"))
    forward = ck.laws.driven_forward(led, "left", "right")
    assert [drive.name for drive in forward.drives] == ["left", "right"]
    assert loads(dumps(forward)) == forward
    motion = ck.solve(forward, time=np.linspace(0.0, SPAN, 999))
    size = motion.mechanism.geometry.size
    off = np.abs(motion.points["P"].position - circle(motion.time))
    assert np.max(off) < BETWEEN * size
    np.testing.assert_allclose(np.abs(motion.points["P"].position[[0, -1]] - MIDDLE), RADIUS, atol=1e-11)
    assert motion.structure.groups[0].links == ("outer-left", "outer-right")


ROBOTS = {
    "3-rrr": ("platform", "P", ("crank-1", "crank-2", "crank-3")),
    "hydraulic-digger": ("bucket", "M", ("boom-cylinder", "stick-cylinder", "bucket-cylinder")),
}


@pytest.mark.parametrize("name", ROBOTS)
def test_robots_of_three_drivers_are_driven_forward(name: str) -> None:
    whole = loaded(name)
    link, letter, drivers = ROBOTS[name]
    values = {k: float(np.mean(c.stroke)) for k, c in whole.cylinders.items()}
    values = values or {drive.name: float(drive.values[0]) for drive in whole.drives}
    ahead = ck.solve(whole, values, order=0)
    start, angle = complex(ahead.points[letter].position), float(ahead.links[link].angle)
    step = 0.02 * whole.geometry.size
    drawing = ck.drawn(**{k: complex(p.position) for k, p in ahead.points.items()})
    led = redriven(
        name,
        ck.drive(letter, along=lambda t: start + step * (np.exp(1j * t) - 1.0)),
        ck.drive(link, angle=lambda t: angle + 0.05 * np.sin(t)),
    ).replace(drawing)
    motion = ck.solve(led, time=np.linspace(0.0, 2.0, 41))
    forward = ck.solve(ck.laws.driven_forward(motion, *drivers), time=np.linspace(0.0, 2.0, 77))
    t = forward.time
    np.testing.assert_allclose(forward.points[letter].position, start + step * (np.exp(1j * t) - 1), atol=1e-8 * step)
    np.testing.assert_allclose(
        np.exp(1j * forward.links[link].angle), np.exp(1j * (angle + 0.05 * np.sin(t))), atol=1e-9
    )


def test_the_law_of_a_crank_is_found_from_its_rocker() -> None:
    """A rocker at a constant speed; the crank's law has the closed form of the four-bar's loop in between."""
    times = np.linspace(0.0, 1.0, 41)
    ahead = ck.solve(four_bar(ck.drive("crank", values=1.2)))
    drawing = ck.drawn(**{k: complex(p.position) for k, p in ahead.points.items()})
    start = float(ahead.links["rocker"].angle)
    led = four_bar(ck.drive("rocker", law=ck.laws.constant_speed(0.2, start)), drawing)
    found = ck.laws.found_law(ck.solve(led, time=times), "crank")
    t = np.linspace(0.0, 1.0, 333)
    end = 4.0 + 3.0 * np.exp(1j * (start + 0.2 * t))
    d = np.abs(end)
    closed = [np.angle(end) + s * np.arccos((1.0 + d**2 - 9.0) / (2.0 * d)) for s in (1, -1)]
    law = found.coordinate(t, 2)
    assert min(np.max(np.abs(law.c[0] - one)) for one in closed) < BETWEEN
    # against another link, the other way round
    motion = ck.solve(led, time=times)
    there = ck.laws.found_law(motion, "coupler", "crank").values
    back = ck.laws.found_law(motion, "crank", "coupler").values
    np.testing.assert_allclose(there, -back, atol=1e-12)


def test_a_motion_table_meets_what_it_is_given() -> None:
    table = ck.laws.motion_table(TIMES, np.sin(TIMES), np.cos(TIMES), -np.sin(TIMES))
    found = table.coordinate(np.concatenate([TIMES, TIMES[:-1] + 0.02]), 3)
    t = np.concatenate([TIMES, TIMES[:-1] + 0.02])
    for k, (exact, off) in enumerate(((np.sin(t), 1e-12), (np.cos(t), 1e-9), (-np.sin(t), 1e-7), (-np.cos(t), 1e-3))):
        np.testing.assert_allclose(found.derivative(k), exact, atol=off)
    with pytest.raises(ck.errors.InvalidInput, match="outside its table"):
        table.coordinate(2.1, 0)
    with pytest.raises(ck.errors.InvalidMechanism, match="four lists of one length"):
        ck.laws.motion_table([0, 1], [0, 1], [0, 0], [0])


@pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")
def test_what_cannot_be_found_says_why() -> None:
    led, at_values = ck.solve(loaded("five-bar-led")), ck.solve(loaded("five-bar"))
    far = ck.solve(redriven("five-bar", ck.drive("P", along=[(60, 130), (60, 190)], time=[0, 1])), time=TIMES / 2)
    still = ck.solve(loaded("five-bar-led"), time=0.5)
    for motion, names, said in (
        (at_values, ("left",), "not in time"),
        (led, ("outer-left",), "share no pair that could be driven"),
        (led, ("lft",), "did you mean 'left'"),
        (led, (), "none is named"),
        (far, ("left",), r"cannot be followed from 0.66\d* s to 1 s: \|AP\| ="),
        (ck.solve(loaded("five-bar-led"), order=1), ("left",), "order"),
        (still, ("left",), "single pose|several designs"),
    ):
        with pytest.raises(ck.errors.CompoundkinError, match=said):
            ck.laws.driven_forward(motion, *names)


def test_the_command_line_writes_the_mechanism_driven_forward(tmp_path: object) -> None:
    ran = CliRunner().invoke(cli, ["solve", "five-bar-led", "--forward", "left,right"])
    assert ran.exit_code == 0, ran.output
    assert [drive.name for drive in loads(ran.stdout).drives] == ["left", "right"]
    path = f"{tmp_path}/forward.json"
    ran = CliRunner().invoke(cli, ["solve", "five-bar-led", "--forward", "left,outer-left/left", "-o", path])
    assert ran.exit_code == 0, ran.output
    assert [(d.link, d.on) for d in ck.load(path).drives] == [("left", "frame"), ("outer-left", "left")]
    assert CliRunner().invoke(cli, ["solve", "five-bar-led", "--forward", "left", "-o", "x.csv"]).exit_code == 2


def test_a_path_that_returns_a_pair_of_arrays_is_refused() -> None:
    arm = loaded("five-bar-led")
    kept = [item for item in arm.items if not isinstance(item, PrescribedMotion | Expectation)]
    led = ck.Mechanism("Robot", *kept, ck.drive("P", along=lambda t: (60.0 + 0.0 * t, 135.0 + 0.0 * t)))
    with pytest.raises(ck.errors.InvalidInput, match=r"several arrays.*return x \+ 1j \* y"):
        ck.solve(led, time=[0.0, 1.0])


def test_a_value_to_hold_that_is_not_finite_names_its_drive() -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match=r"drives\.P\.x: nan is not a finite number"):
        ck.drive("P", x=np.nan)


def test_a_single_pose_in_time_is_no_motion_to_find_a_law_of() -> None:
    pose = ck.solve(loaded("five-bar-led"), time=0.3)
    with pytest.raises(ck.errors.InvalidInput, match="a single pose is no motion"):
        ck.laws.found_law(pose, "left")
