"""`compoundkin forces`, `simulate`, and forces in other verbs: what they print and write, and wrong input."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

import compoundkin as ck
from compoundkin.cli import cli
from tests.view.loaded import six_bar

Run = Callable[..., Result]
FILES = {"loaded": "loaded.toml", "pendulum": "pendulum.toml"}


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    monkeypatch.chdir(tmp_path)
    for made in (six_bar(), pendulum()):
        ck.save(made, "pendulum.toml" if made.title == "Pendulum" else "loaded.toml")
    return lambda *args: CliRunner().invoke(cli, [FILES.get(one, one) for one in args], catch_exceptions=True)


def pendulum() -> ck.Mechanism:
    frame, arm = ck.link("frame", A=(0, 0)), ck.link("arm", A=(0, 0), B=(0.5, 0))
    units = {"length": "m", "mass": "kg", "force": "N"}
    weight = ck.mass("arm", 2.0, at="B", inertia=0.0), ck.gravity(0, -9.81)
    return ck.Mechanism("Pendulum", frame, arm, ck.drive("arm"), *weight, units=units)


def test_forces_are_printed_and_written(run: Run, tmp_path: Path) -> None:
    text = run("forces", "loaded", "--at", "35").stdout
    assert text.index("Assumed:") < text.index("Masses") < text.index("Loads:") < text.index("Reactions")
    still = json.loads(run("forces", "loaded", "--at", "35", "--statics", "--format", "json").stdout)
    assert "statics: no inertia" in still["sections"]["forces"]["blocks"][0]["text"]
    held = run("forces", "loaded", "--at", "35", "--statics", "--holding", "B").stdout
    assert "B holds in the drivers' place" in held.replace("\n", " ")
    assert run("forces", "loaded", "--at", "0,35", "-o", "forces.md").exit_code == 0
    assert "## Forces" in (tmp_path / "forces.md").read_text(encoding="utf-8")


def test_quantities_of_forces_are_columns(run: Run) -> None:
    found = run("solve", "loaded", "--at", "35", "--speed", "20", "--output", "crank.effort,A.force")
    head, row = found.stdout.splitlines()[-2:]
    values = {name.partition(" ")[0]: text for name, text in zip(head.split(","), row.split(","), strict=True)}
    forces = ck.force_analysis(ck.solve(six_bar(), {"crank": ck.deg([35])}, speed=20.0))
    assert float(values["crank.effort"]) == pytest.approx(float(forces.drives["crank"].effort[0]))
    assert float(values["A.force.x"]) == pytest.approx(forces.pairs["A"].force[0].real)


def test_a_free_body_is_a_table(run: Run) -> None:
    told = json.loads(run("forces", "loaded", "--at", "35", "--on", "plate", "--format", "json").stdout)
    (table,) = [block for block in told["sections"]["free-body"]["blocks"] if block["kind"] == "table"]
    *acting, whole = table["rows"]
    forces = np.array([row[4] for row in acting])
    assert whole[0] == "sum"
    assert len(acting) >= 4
    assert np.allclose(forces.sum(0), whole[4], atol=1e-9 * np.abs(forces).max())
    assert np.allclose(whole[4], 0.0, atol=1e-9 * np.abs(forces).max())
    assert "the first of" in run("forces", "loaded", "--on", "plate").stdout


def test_forces_are_a_table(run: Run, tmp_path: Path) -> None:
    named = "--output", "crank.effort,A.force"
    still = run("forces", "loaded", "--at", "0,35", "--statics", *named).stdout.splitlines()
    expected = ck.force_analysis(ck.solve(six_bar(), {"crank": ck.deg([0, 35])}), inertia=False).drives["crank"].effort
    column = [name.partition(" ")[0] for name in still[0].split(",")].index("crank.effort")
    assert [float(row.split(",")[column]) for row in still[1:]] == pytest.approx(list(expected))
    assert run("forces", "loaded", "--at", "35", "-o", "forces.csv").exit_code == 0
    assert "A.moment" in (tmp_path / "forces.csv").read_text(encoding="utf-8")
    assert run("forces", "loaded", "--at", "35", *named, "-o", "forces.json").exit_code == 0
    assert "columns" in json.loads((tmp_path / "forces.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("option", [("--forces",), ("--free-bodies",), ("--free-body", "plate"),
                                    ("--force-polygons",), ("--force-polygon", "bar")])  # fmt: skip
def test_pictures_of_forces(run: Run, tmp_path: Path, option: tuple[str, ...]) -> None:
    assert run("draw", "loaded", "--at", "35", *option, "-o", "forces.svg").exit_code == 0
    assert "ck-reaction" in (tmp_path / "forces.svg").read_text(encoding="utf-8")


def test_bearing_loads_are_plotted(run: Run, tmp_path: Path) -> None:
    assert run("plot", "loaded", "D", "--bearing", "-o", "bearing.svg").exit_code == 0
    assert (tmp_path / "bearing.svg").stat().st_size > 1000


def test_a_pendulum_is_let_go(run: Run, tmp_path: Path) -> None:
    # a small swing about the lowest place: its period is that of the mathematical pendulum
    period = 2.0 * np.pi * np.sqrt(0.5 / 9.81)
    done = run("simulate", "pendulum", "--until", str(period), "--start", "arm=-89", "--output", "arm", "-o", "arm.csv")
    assert done.exit_code == 0, done.output
    last = (tmp_path / "arm.csv").read_text(encoding="utf-8").splitlines()[-1]
    assert float(last.split(",")[1]) == pytest.approx(-89.0, abs=1e-4)
    told = run("simulate", "pendulum", "--until", "1", "--start", "arm=0", "--start", "arm.speed=60rpm").stdout
    assert "Free under masses and loads for 1 s" in told
    # it starts at rest but for its turn of 2 pi rad/s: kinetic energy m v^2 / 2
    kinetic = next(line for line in told.splitlines() if line.startswith("kinetic")).split()
    assert float(kinetic[3]) == pytest.approx(2.0 * (np.pi) ** 2 / 2.0, rel=1e-5)
    assert run("simulate", "pendulum", "--until", "0.2", "--start", "arm=0", "-o", "arm.html").exit_code == 0
    page = (tmp_path / "arm.html").read_text(encoding="utf-8")
    assert "ck-reaction" in page
    assert "the energy balance is off by at most" in page


def test_a_table_names_the_phases(run: Run, tmp_path: Path) -> None:
    text = (tmp_path / "pendulum.toml").read_text(encoding="utf-8")
    opened = '\n[[releases]]\npair = "A"\nuntil = 0.1\n'
    (tmp_path / "breaking.toml").write_text(text + opened, encoding="utf-8")
    wanted = "--start", "arm=0", "--output", "arm.angle", "-o", "arm.csv"
    done = run("simulate", "breaking.toml", "--until", "0.2", *wanted)
    assert done.exit_code == 0, done.output
    head, *rows = (tmp_path / "arm.csv").read_text(encoding="utf-8").splitlines()
    assert head.startswith("phase,time [s]")
    assert {row.split(",")[0] for row in rows} == {"1", "2"}
    # each phase has the time at which the pin opens
    assert [row.split(",")[1] for row in rows].count("0.1") == 2


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (("forces", "six-bar"), "units"),
        (("draw", "loaded", "--free-body", "plat"), "did you mean"),
        (("draw", "loaded", "--forces", "--ghosts", "3"), "does not go with"),
        (("draw", "loaded", "--statics"), "give --forces too"),
        (("forces", "loaded", "--at", "35", "--holding", "Z"), "Z"),
        (("forces", "loaded", "--on", "plat"), "did you mean"),
        (("forces", "loaded", "--on", "plate", "--output", "A.force"), "does not go with --output"),
        (("forces", "loaded", "--output", "A.force", "-o", "forces.html"), "a table is not saved"),
        (("plot", "loaded", "--bearing", "Z"), "there is no such pair"),
        (("simulate", "pendulum", "--until", "1", "--start", "arm.speed=5"), "give --start arm=VALUE too"),
        (("simulate", "pendulum", "--until", "1", "--start", "arn=5"), "did you mean"),
        (("simulate", "pendulum", "--until", "1", "-o", "arm.xyz"), "not saved"),
        (("simulate", "six-bar", "--until", "1"), "units"),
    ],
)
def test_wrong_input(run: Run, args: tuple[str, ...], said: str) -> None:
    result = run(*args)
    assert result.exit_code != 0
    assert said in result.output + str(result.exception)


def test_the_statics_of_a_lift_are_three_commands(run: Run, tmp_path: Path) -> None:
    """Those of the page; y = 2 sqrt(L^2 - x^2) gives the thrust by virtual work."""
    page = (Path(__file__).parents[2] / "docs" / "cli.md").read_text(encoding="utf-8")
    section = page[page.index("## Forces") : page.index("## Equations")]
    commands = [line.split()[1:] for line in section.splitlines() if line.startswith("    compoundkin ")]
    assert len(commands) == 3
    for command in commands:
        found = run(*command)
        assert found.exit_code == 0, found.output
    told = json.loads(run(*commands[1], "--format", "json").stdout)
    tables = [block for block in told["sections"]["forces"]["blocks"] if block["kind"] == "table"]
    (drivers,) = [table for table in tables if table["columns"][0]["name"] == "driver"]
    assert drivers["rows"][0][:3] == ["foot-block", "thrust", "N"]
    assert drivers["rows"][0][3] == pytest.approx(-3000 * 2 * 1.6 / 1.2, rel=1e-12)
    assert "-8000 N" in section
    assert "The free body of platform" in (tmp_path / "lift.html").read_text(encoding="utf-8")


def efforts(run: Run, *options: str) -> float:
    found = run("forces", "scissor-lift", "--at", "1.6", "--statics", "--output", "foot-block.effort", *options)
    assert found.exit_code == 0, found.output
    head, row = found.stdout.splitlines()[-2:]
    return float(row.split(",")[[name.partition(" ")[0] for name in head.split(",")].index("foot-block.effort")])


def test_loads_of_the_command_line_are_in_their_units(run: Run) -> None:
    lifted = -2 * 1.6 / 1.2  # dy/dx of the platform; its arms 1 and 2 are lifted by a quarter of that
    assert efforts(run, "--load", "platform.T=0,-3 kN") == pytest.approx(3000 * lifted)
    assert efforts(run, "--load", "E=70,-100", "--load", "T=0,-200") == pytest.approx(300 * lifted)
    weighed = "--mass", "platform=60", "--mass", "arm-1=15000 g", "--gravity", "0,-10"
    assert efforts(run, *weighed) == pytest.approx((600 + 150 / 4) * lifted)
    # arm 1 turns by dphi = -dx / (L sin phi)
    assert efforts(run, "--torque", "arm-1=120 N mm") == pytest.approx(0.12 / 1.2)
    assert efforts(run, "--units", "m,lb,lbf", "--load", "T=0,-3 N") == pytest.approx(3 / 4.4482216152605 * lifted)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("--load", "Q=0,-3"), "there is no point 'Q'"),
        (("--load", "arm-9.T=0,-3"), "did you mean 'arm-4'?"),
        (("--load", "arm-1.T=0,-3"), "it is on platform"),
        (("--load", "T=0,-3,4"), "3 numbers instead of 2"),
        (("--load", "T=0,-3 kNN"), "did you mean 'kN'?"),
        (("--load", "0,-3"), "it names nothing"),
        (("--load", "T=0,x"), "'x' is not a number"),
        (("--load", "T=0,-1", "--load", "platform.T=0,-2"), "two are on platform"),
        (("--torque", "arm-9=1"), "there is no link 'arm-9'"),
        (("--torque", "arm-1=1 N"), "'N' is no unit here"),
        (("--mass", "arm-1=-3"), "a mass is above zero"),
        (("--mass", "frame=3"), "frame"),
        (("--gravity", "9"), "1 number instead of 2"),
        (("--units", "m,kg", "--load", "T=0,-1"), "2 units instead of 3"),
        (("--units", "mm,kg,N", "--load", "T=0,-1"), "lengths are in m"),
        (("--units", "m,kg,M", "--load", "T=0,-1"), "no known unit of force"),
    ],
)
def test_loads_that_cannot_be_are_explained(run: Run, options: tuple[str, ...], told: str) -> None:
    found = run("forces", "scissor-lift", "--at", "1.6", *options)
    assert found.exit_code == 2
    assert told in " ".join(found.output.split())


def test_units_are_needed_once(run: Run) -> None:
    assert "write a unit of length" in run("forces", "jansen-leg", "--load", "G=0,-3").output
    assert "the file has units: mm, kg, N" in run("forces", "loaded", "--units", "mm,kg,N", "--load", "G=0,-3").output
    assert run("draw", "scissor-lift", "--at", "1.6", "--load", "T=0,-3", "--free-bodies", "-o", "a.svg").exit_code == 0
    fallen = run(
        "simulate", "crank-rocker", "--until", "0.1", "--mass", "crank=2", "--gravity", "0,-9.81", "--units", "mm,kg,N"
    )
    assert fallen.exit_code == 0, fallen.output


def test_strength_is_printed_and_its_loads_are_a_table(run: Run, tmp_path: Path) -> None:
    """The pendulum at rest and level: m g l at its pin."""
    text = run("forces", "pendulum", "--at", "0", "--statics", "--strength").stdout
    assert "arm: bar A-B" in text
    assert re.search(r"least bending moment\s+-9.81\s+N m\s+0 m from A", text)
    assert run("forces", "pendulum", "--at", "0", "--statics", "--strength", "-o", "loads.csv").exit_code == 0
    assert "arm.pair A.force.y [N]" in (tmp_path / "loads.csv").read_text()
    refused = run("forces", "pendulum", "--strength", "--sheet")
    assert "does not go with --sheet" in refused.stderr


def test_diagrams_of_bars(run: Run, tmp_path: Path) -> None:
    assert run("forces", "engine-gas-pressure", "--strength", "--bar", "rod", "-o", "rod.svg").exit_code == 0
    assert (tmp_path / "rod.svg").stat().st_size > 5000
    assert run("draw", "engine-gas-pressure", "--at", "75", "--along-bars", "shear", "-o", "bars.svg").exit_code == 0
    assert "ck-area" in (tmp_path / "bars.svg").read_text(encoding="utf-8")
    sizes = "--section", "rod=0.02x0.03", "--elasticity", "rod=2.1e11", "--pin", "A=0.02,0.03"
    text = run("forces", "engine-gas-pressure", "--strength", *sizes).stdout
    # pi^2 E b h^3 / 12 / l^2
    load = np.pi**2 * 2.1e11 * 0.02 * 0.03**3 / 12 / 0.2**2
    assert f"{load:.6g}" in text
    assert "bearing pressure" in text


@pytest.mark.parametrize(("words", "said"), [
    (("--bar", "rod"), "--strength"), (("--strength", "--section", "rod"), "NAME="),
    (("--strength", "--section", "rod=1x2x3"), "8x20"), (("--strength", "--pin", "A=3"), "diameter"),
    (("--strength", "--bar", "rodd"), "'rod'"), (("--strength", "-o", "a.gif"), "gif"),
])  # fmt: skip
def test_wrong_words_for_bars(run: Run, words: tuple[str, ...], said: str) -> None:
    result = run("forces", "engine-gas-pressure", *words)
    assert result.exit_code == 2
    assert said in result.stderr
    assert "Traceback" not in result.stderr


def test_the_motor_at_its_shaft_is_drawn(run: Run, tmp_path: Path) -> None:
    assert run("size", "shaper-cutting-force", "-o", "servo.svg").exit_code == 0
    assert (tmp_path / "servo.svg").stat().st_size > 5000
    weak = run("size", "shaper-cutting-force", "--motor", "gearmotor 24 V 20 W", "-o", "weak.png")
    assert weak.exit_code == 0
    assert (tmp_path / "weak.png").exists()
    for words, said in ((("--motor", "servo 100 W"), "-o PATH.svg"), (("--motor", "serv", "-o", "a.svg"), "servo"),
                        (("-o", "a.csv"), "plot")):  # fmt: skip
        wrong = run("size", "shaper-cutting-force", *words)
        assert wrong.exit_code == 2
        assert said in wrong.stderr
    assert not (tmp_path / "a.svg").exists()
