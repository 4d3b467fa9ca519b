"""The sheet of forces: its equations read again, term by term, against forces and balances computed elsewhere."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import compoundkin as ck
from compoundkin.cli import cli
from compoundkin.view.report.report_data import Alert, FormulaBlock, Paragraph, Section, TableBlock
from tests.view.loaded import six_bar

UNITS = {"length": "mm", "mass": "kg", "force": "N"}
NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e[-+]\d+)?")


def pump() -> ck.Mechanism:
    frame, crank = ck.link("frame", O=(0, 0)), ck.link("crank", O=(0, 0), A=(50, 0))
    rod, piston = ck.link("rod", A=(0, 0), B=(200, 0)), ck.link("piston", B=(0, 0))
    guide = ck.slide("piston", on="frame", at="B", through="O", name="guide")
    loads = ck.force("piston", (-2000, 0), at="B", name="gas"), ck.mass("rod", 8, at=(70, 5)), ck.gravity(0, -9.81)
    rubbing = ck.friction("guide", 0.1, length=80), ck.torque("rod", 700, name="Mr")
    return ck.Mechanism("Pump", frame, crank, rod, piston, guide, ck.drive("crank"), *loads, *rubbing, units=UNITS)


CASES = {
    "pump": (pump(), {"crank": ck.deg(60)}),
    "six-bar": (six_bar(), {"crank": ck.deg(35)}),
    "scissor lift": (ck.load("scissor-lift-loaded"), {"foot-block": 1.6}),
    "cam": (ck.load("cam-return-spring"), {"cam": ck.deg(60)}),
    "gears": (ck.load("planetary-train-torques"), None),
}


def forces_of(name: str, inertia: bool = True) -> ck.results.Forces:
    mechanism, at = CASES[name]
    return ck.force_analysis(
        ck.solve(mechanism, None if at is None else {key: [one] for key, one in at.items()}), inertia=inertia
    )


def bodies(report: ck.results.Report) -> Iterator[tuple[str, Section]]:
    """The sections of links, by the links' names."""
    for section in report.sections:
        if section.key.startswith("sheet-"):
            yield section.title.partition(" ")[2], section


def equations(section: Section) -> dict[str, list[str]]:
    """What stands right of the sums, in symbols and with numbers, by the sum's name."""
    found: dict[str, list[str]] = {}
    for block in section.blocks:
        if isinstance(block, FormulaBlock):
            name, _, rest = block.text.partition(" = ")
            found.setdefault(name, []).append(rest)
    return found


def value(text: str) -> float:
    """The value of an expression of numbers, signs, parentheses and products."""
    assert re.fullmatch(r"[-+·(). 0-9e]*", text)
    return float(eval(text.replace("·", "*"), {"__builtins__": {}}))


def scale(text: str) -> float:
    """The greatest term of an expression."""
    return max(abs(value(term)) for term in re.split(r" [-+] ", text))


@pytest.mark.parametrize("inertia", [True, False])
@pytest.mark.parametrize("name", CASES)
def test_the_equations_read_again_sum_to_zero(name: str, inertia: bool) -> None:
    report = ck.sheet(forces_of(name, inertia))
    count = 0
    for link, section in bodies(report):
        for sum_, parts in equations(section).items():
            if len(parts) == 1:
                assert parts[0].startswith("0, for nothing")
                continue
            symbols, numbers = parts
            terms, _, total = numbers.rpartition(" = ")
            assert value(terms) == pytest.approx(float(total), rel=1e-5, abs=1e-9 * scale(terms)), (link, sum_)
            assert len(re.split(r" [-+] (?!x|y)", symbols)) >= 1
            if link != "frame":
                assert symbols.endswith(" = 0")
                assert abs(value(terms)) <= 3e-5 * scale(terms), (link, sum_)
                count += 1
    assert count >= 4


@pytest.mark.parametrize("name", CASES)
def test_sums_of_the_frame_are_what_acts_on_it(name: str) -> None:
    """The wrench on the frame by Newton and Euler for the whole, not by the sheet's own terms."""
    forces = forces_of(name)
    ((link, section), *_) = bodies(ck.sheet(forces))
    assert link == "frame"
    on_frame = forces.on("frame")
    design = (0,) * len(forces.shape)
    wanted = complex(np.asarray(on_frame.force)[design]) if name != "gears" else None
    found = {key: float(parts[-1].rpartition(" = ")[2]) for key, parts in equations(section).items() if len(parts) == 2}
    if wanted is not None:
        size = forces.largest
        assert found.get("ΣFx", 0.0) == pytest.approx(wanted.real, abs=3e-5 * size)
        assert found.get("ΣFy", 0.0) == pytest.approx(wanted.imag, abs=3e-5 * size)
    (moment,) = [key for key in equations(section) if key.startswith("ΣM")]
    letter = moment[3:-1]
    if letter in forces.points and wanted is not None:
        about = float(np.asarray(on_frame.moment_about(letter))[design])
        assert found.get(moment, 0.0) == pytest.approx(about, abs=3e-5 * size * forces.motion.size)


def test_the_forces_are_those_of_the_analysis_and_are_opposite_on_both_links() -> None:
    forces = forces_of("pump")
    rows = {}
    for _, section in bodies(ck.sheet(forces)):
        (table,) = [block for block in section.blocks if isinstance(block, TableBlock)]
        rows |= {row[0]: row for row in table.rows}
    for pair, ends in {"O": "12", "A": "23", "B": "34"}.items():
        names = [
            "F" + ends.translate(str.maketrans("1234", "₁₂₃₄")),
            "F" + ends[::-1].translate(str.maketrans("1234", "₁₂₃₄")),
        ]
        one, other = (complex(*rows[name][3:5]) for name in names)
        assert one == pytest.approx(-other)
        assert abs(one) == pytest.approx(float(np.abs(forces.pairs[pair].force)[0]), rel=1e-12)
        assert rows[names[0]][5] == pytest.approx(abs(one))
        assert rows[names[0]][6] == pytest.approx(np.rad2deg(np.angle(one)))
    assert rows["gas"][3:7] == (-2000.0, 0.0, 2000.0, pytest.approx(180.0))
    assert rows["m₃g"][4] == pytest.approx(-8 * 9.81)
    assert rows["T₂"][7] == pytest.approx(float(forces.drives["crank"].effort[0]), rel=1e-12)
    assert rows["guide"][3] == pytest.approx(0.1 * abs(rows["F₁₄"][4])), "friction, against the motion"


def test_symbols_and_numbers_have_the_same_terms() -> None:
    """Each symbol replaced by its number from the tables gives the numbers that were put in."""
    for _, section in bodies(ck.sheet(forces_of("pump"))):
        (table,) = [block for block in section.blocks if isinstance(block, TableBlock)]
        (points,) = [
            block.text for block in section.blocks if isinstance(block, Paragraph) and block.text.startswith("Points")
        ]
        known: dict[str, float] = {}
        for letter, x, y in re.findall(r"(\w+) \(([-\d.e]+), ([-\d.e]+)\)", points):
            known |= {f"x{letter}": float(x), f"y{letter}": float(y)}
        for row in table.rows:
            name, *turning = str(row[0]).split(", ")
            signed = f"({name})" if name.startswith("−") else name
            known |= {f"{signed},x": row[3], f"{signed},y": row[4]} if row[5] else {signed: row[7]}
            known |= {f"({one})" if one.startswith("−") else one: row[7] for one in turning}
        for parts in equations(section).values():
            if len(parts) == 2:
                symbols, numbers = parts[0].removesuffix(" = 0"), parts[1].rpartition(" = ")[0]
                for key in sorted(known, key=len, reverse=True):
                    symbols = symbols.replace(key, f"({known[key]:.12f})")
                assert value(symbols) == pytest.approx(value(numbers), abs=3e-5 * scale(numbers))


def test_what_equilibrium_leaves_open_has_no_sum() -> None:
    held = ck.load("parallelogram-third-crank").replace(unit="", units=UNITS)
    loaded = held.replace(ck.force(next(one for one in held.links if one != "frame"), (3, 4), at=(1, 0)))
    report = ck.sheet(ck.force_analysis(ck.solve(loaded, {"crank": [1.0]})))
    alerts = [block for _, section in bodies(report) for block in section.blocks if isinstance(block, Alert)]
    assert alerts
    assert "does not determine" in alerts[0].text


def test_a_pose_between_those_of_the_motion_is_solved() -> None:
    forces = ck.force_analysis(ck.solve(pump(), {"crank": ck.deg([0, 50, 100])}, speed=7))
    there = ck.force_analysis(ck.solve(pump(), {"crank": ck.deg([60])}, speed=7))
    between, wanted = (
        [block.text for _, section in bodies(report) for block in section.blocks if isinstance(block, FormulaBlock)]
        for report in (ck.sheet(forces, at=ck.deg(60)), ck.sheet(there))
    )
    assert between == wanted
    with pytest.raises(ck.errors.InvalidInput, match="there is no pose 9"):
        ck.sheet(forces, pose=9)


def test_the_command_writes_a_page_for_each_link(tmp_path: Path) -> None:
    page, text = tmp_path / "sheet.html", CliRunner()
    told = text.invoke(cli, ["forces", "scissor-lift-loaded", "--at", "1.6", "--statics", "--sheet", "-o", str(page)])
    assert told.exit_code == 0, told.output
    html = page.read_text(encoding="utf-8")
    assert html.count("<figcaption>The free body of") == html.count('<section id="sheet-') == 8
    assert "break-before: page" in html
    printed = text.invoke(cli, ["forces", "scissor-lift-loaded", "--at", "1.6", "--statics", "--sheet"]).stdout
    # virtual work: arms are lifted by 1/2 and 3/2, block, platform and load by 2 of the height of the lower scissor
    thrust = (9.81 * (2 * 15 * 0.5 + 2 * 15 * 1.5 + 62 * 2) + 3000 * 2) * 1.6 / 1.2
    assert f"{-thrust:.6g}" in printed
    wrong = text.invoke(cli, ["forces", "scissor-lift-loaded", "--at", "1.6", "--sheet", "--on", "arm-1"])
    assert wrong.exit_code == 2
    assert "leave one of them out" in wrong.output
