"""Constructions of GeoGebra as people save them, read as the mechanisms they move as."""

from __future__ import annotations

import html
import io
import random
import re
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import compoundkin as ck
from compoundkin.base.errors import CompoundkinError, InvalidInput
from compoundkin.cli import cli
from tests.files.exchange.shown_catalog import shown

A, D = 0j, 6 + 0j


def meeting(one: complex, r: float, two: complex, s: float) -> complex:
    """Where circles meet, to the left of the way between their centres: by the law of cosines."""
    far = abs(two - one)
    turn = np.arccos((r * r + far * far - s * s) / (2 * r * far))
    return complex(one + (two - one) / far * r * np.exp(1j * turn))


def object_(kind: str, name: str, at: complex | None = None, show: bool = True) -> str:
    place = "" if at is None else f'<coords x="{at.real!r}" y="{at.imag!r}" z="1"/>'
    return f'<element type="{kind}" label="{name}"><show object="{str(show).lower()}"/>{place}</element>'


def slider(name: str, value: float, low: float, high: float, kind: str = "numeric") -> str:
    ends = f'<slider min="{low}" max="{high}"/>'
    return f'<element type="{kind}" label="{name}"><value val="{value!r}"/>{ends}</element>'


def command(name: str, given: list[str], *made: str) -> str:
    rows = [" ".join(f'a{k}="{html.escape(word)}"' for k, word in enumerate(words)) for words in (given, made)]
    return f'<command name="{name}"><input {rows[0]}/><output {rows[1]}/></command>'


def bar(name: str, *ends: str) -> str:
    return command("Segment", [*ends], name) + object_("segment", name)


def expression(name: str, text: str, kind: str = "point") -> str:
    return f'<expression label="{name}" exp="{html.escape(text)}" type="{kind}"/>' + object_(kind, name)


def construction(*parts: str) -> str:
    inside = f'<construction title="" author="Somebody">{"".join(parts)}</construction>'
    return f'<?xml version="1.0" encoding="utf-8"?>\n<geogebra format="5.0">{inside}</geogebra>'


def packed(text: str | bytes, name: str = "geogebra.xml") -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("geogebra_thumbnail.png", b"\x89PNG")
        archive.writestr(name, text)
    return file.getvalue()


B = complex(2 * np.exp(1j))
FOUR_BAR = construction(
    object_("point", "A", A), object_("point", "D", D),
    command("Circle", ["A", "2"], "c"), object_("conic", "c"), command("Point", ["c"], "B"), object_("point", "B", B),
    command("Circle", ["B", "5"], "d"), command("Circle", ["D", "4"], "e"),
    command("Intersect", ["d", "e"], "C", "F"), object_("point", "C", meeting(B, 5, D, 4)),
    object_("point", "F", meeting(D, 4, B, 5), show=False),
    bar("f", "A", "B"), bar("g", "B", "C"), bar("h", "C", "D"),
)  # fmt: skip
SLIDER_CRANK = construction(
    slider("α", 0.7, 0.0, 2 * np.pi, "angle"), slider("r", 2.0, 1.0, 3.0), object_("point", "O", 0j),
    expression("B", "O + (r; α)"), command("Circle", ["B", "6"], "k"), command("Intersect", ["k", "xAxis"], "C"),
    object_("point", "C", 7.4 + 0j), command("Rotate", ["C", "40°", "B"], "E"), object_("point", "E"),
    command("Polygon", ["B", "C", "E"], "t", "a", "b", "c"), bar("f", "O", "B"),
    command("Locus", ["E", "α"], "way"), object_("locus", "way"), object_("text", "hello"),
)  # fmt: skip
HOIST = construction(
    slider("s", 2.2, 1.8, 3.0), object_("point", "P", 0j), object_("point", "Q", 3 - 1j),
    command("Circle", ["P", "2.5"], "c"), command("Circle", ["Q", "s"], "d"), command("Intersect", ["c", "d"], "T"),
    object_("point", "T", meeting(0j, 2.5, 3 - 1j, 2.2)), command("Dilate", ["T", "2", "P"], "U"),
    object_("point", "U"),
    bar("f", "P", "U"), bar("g", "Q", "T"),
)  # fmt: skip
GEARS = construction(
    slider("α", 20.0, 0.0, 360.0), object_("point", "O", 0j), object_("point", "Q", 3 + 0j),
    expression("B", "O + (1; α°)"), expression("E", "Q + (0.8; -α° / 2)"), bar("f", "O", "B"), bar("g", "Q", "E"),
)  # fmt: skip
LEVER = construction(
    slider("α", 0.4, 0.0, 6.283185307179586, "angle"), object_("point", "A", 0j), object_("point", "O", 3j),
    expression("K", "O + 1.2 (cos(α), sin(α))"), command("Ray", ["A", "K"], "r"), command("Circle", ["A", "6"], "c"),
    command("Intersect", ["c", "r"], "L"), object_("point", "L", 5j), bar("f", "A", "L"), bar("g", "O", "K"),
)  # fmt: skip


def places(text: str, *letters: str) -> tuple[ck.exchange.Imported, list[Any]]:
    found = ck.exchange.read(text)
    motion = ck.solve(found.mechanism)
    assert motion.assembled.all()
    return found, [np.ravel(motion.points[letter].position) for letter in letters]


def test_a_pin_dragged_on_a_circle_is_a_crank() -> None:
    found, (b, c) = places(FOUR_BAR, "B", "C")
    assert [*found.mechanism.links] == ["frame", "AB", "BC", "DC"]
    assert np.ptp(np.unwrap(np.angle(b))) == pytest.approx(2 * np.pi)
    np.testing.assert_allclose(c, [meeting(pin, 5, D, 4) for pin in b], atol=1e-12)


def test_a_slider_of_an_angle_drives_one_of_a_length_does_not() -> None:
    found, (b, c, e) = places(SLIDER_CRANK, "B", "C", "E")
    np.testing.assert_allclose(c, b.real + np.sqrt(36 - b.imag**2), atol=1e-12)
    np.testing.assert_allclose(e, b + (c - b) * np.exp(1j * np.deg2rad(40)), atol=1e-12)
    assert [group.name for group in ck.decompose(found.mechanism).groups] == ["RRP"]
    assert any("r changes lengths: it is a dimension, 2" in note for note in found.notes)
    assert any("1 text" in note for note in found.notes)
    assert found.mechanism.outputs == ("E.position",)


def test_a_slider_of_a_length_alone_is_a_cylinder() -> None:
    _, (t, u) = places(HOIST, "T", "U")
    lengths = np.abs(t - (3 - 1j))
    assert (lengths.min(), lengths.max()) == (pytest.approx(1.8), pytest.approx(3.0))
    np.testing.assert_allclose(u, 2 * t, atol=1e-12)
    np.testing.assert_allclose(np.abs(t), 2.5, atol=1e-12)


def test_turns_in_proportion_are_gears() -> None:
    found, (b, e) = places(GEARS, "B", "E")
    turned = np.unwrap(np.angle(e - 3)) - np.angle(e[0] - 3)
    np.testing.assert_allclose(turned, -(np.unwrap(np.angle(b)) - np.angle(b[0])) / 2, atol=1e-12)
    assert len(found.mechanism.written_pairs) == 1


def test_a_point_on_a_moving_line_slides() -> None:
    found, (k, far) = places(LEVER, "K", "L")
    np.testing.assert_allclose(far, 6 * k / np.abs(k), atol=1e-11)
    assert [group.name for group in ck.decompose(found.mechanism).groups] == ["RPR"]


@pytest.mark.parametrize("name", ["crank-rocker", "six-bar", "scotch-yoke", "geared-five-bar", "hydraulic-crane",
                                  "scissor-lift", "planetary-train", "elliptic-trammel"])  # fmt: skip
def test_what_is_written_is_read_back(name: str, tmp_path: Path) -> None:
    ck.exchange.write(shown(name).mechanism, "geogebra").save(tmp_path / "made.ggb")
    again = ck.exchange.read(tmp_path / "made.ggb")
    assert again.form == "geogebra"
    assert ck.exchange.compare(shown(name).mechanism, again.mechanism).within(1e-6)


def test_a_file_is_taken_wherever_a_mechanism_is(tmp_path: Path) -> None:
    (tmp_path / "mine.ggb").write_bytes(packed(FOUR_BAR))
    said = CliRunner().invoke(cli, ["check", str(tmp_path / "mine.ggb")])
    assert said.exit_code == 0, said.output
    made = CliRunner().invoke(cli, ["import", str(tmp_path / "mine.ggb"), "-o", str(tmp_path / "mine.toml")])
    assert made.exit_code == 0, made.output
    assert ck.load(tmp_path / "mine.toml").carriers["B"] == ("AB", "BC")


@pytest.mark.parametrize(("parts", "told"), [
    ((object_("point", "A", 0j), object_("point", "B", 1j), bar("f", "A", "B")), "nothing moves it"),
    ((slider("α", 0.4, 0, 6, "angle"), object_("point", "A", 0j), expression("B", "A + (1; α)"),
      command("Spline", ["A", "B"], "q"), command("Point", ["q"], "C"), object_("point", "C", 1j),
      bar("f", "A", "B"), bar("g", "B", "C")), "C: it depends on q"),
    ((slider("α", 0.4, 0, 6, "angle"), object_("point", "A", 0j), expression("B", "A + (1; α)"),
      expression("C", "(α + 3, sin(3 α))"), bar("f", "A", "B"), bar("g", "B", "C")), "C = (α + 3, sin(3 α)) moves"),
])  # fmt: skip
def test_what_is_not_understood_is_named(parts: tuple[str, ...], told: str) -> None:
    with pytest.raises(InvalidInput, match=re.escape(told)):
        ck.exchange.read(construction(*parts) + "\n")


def test_what_moves_nothing_and_is_not_read_is_noted() -> None:
    extra = command("Spline", ["A", "B"], "q") + object_("curve", "q")
    found = ck.exchange.read(FOUR_BAR.replace("</construction>", f"{extra}</construction>"))
    assert any("q (the command Spline is not read)" in note for note in found.notes)


def locked(raw: bytes) -> bytes:
    """The archive with the mark of a password, in both its headers of the construction."""
    at = raw.index(b"geogebra.xml")
    central = raw.rindex(b"geogebra.xml")
    made = bytearray(raw)
    made[at - 30 + 6] |= 1
    made[central - 46 + 8] |= 1
    return bytes(made)


@pytest.mark.parametrize(("raw", "told"), [
    (packed(b"<geogebra>" + b" " * 20_000_000), "bytes"),
    (packed(FOUR_BAR)[:500], "damaged"),
    (locked(packed(FOUR_BAR)), "locked"),
    (packed(FOUR_BAR, "../geogebra.xml"), "damaged"),
    (packed(FOUR_BAR, "other.xml"), "zip archive"),
    (packed('<!DOCTYPE a [<!ENTITY b "c">]><geogebra/>'), "document type"),
    (packed("<geogebra/>"), "no construction"),
    (packed("<geogebra><a"), "not XML"),
])  # fmt: skip
def test_hostile_archives_are_refused(raw: bytes, told: str, tmp_path: Path) -> None:
    path = tmp_path / "sent.ggb"
    path.write_bytes(raw)
    with pytest.raises(InvalidInput, match=told):
        ck.exchange.read(path)
    assert [*tmp_path.parent.glob("geogebra*")] == []


@pytest.mark.parametrize("text", [
    "(" * 300, "9^9^9^9^9", "__import__('os').system('x')", "A" * 9000, "A + (1/0; α)", "B", "Circle[A", "1" * 400,
])  # fmt: skip
def test_hostile_expressions_are_told(text: str) -> None:
    with pytest.raises(InvalidInput):
        ck.exchange.read(construction(
            slider("α", 0.4, 0, 6, "angle"), object_("point", "A", 0j), expression("B", text), bar("f", "A", "B"),
        ) + "\n")  # fmt: skip


def test_damaged_constructions_are_told() -> None:
    rng = random.Random(3)
    for _ in range(30):
        text = rng.choice([FOUR_BAR, SLIDER_CRANK, HOIST, GEARS, LEVER])
        values = [found.span(1) for found in re.finditer(r'"([^"]*)"', text)]
        (start, end), (low, high) = rng.choice(values), rng.choice(values)
        with_other = rng.choice([text[low:high], "NaN", "-1", "1E308", "(", "Segment", "°"])
        try:
            ck.exchange.read(text[:start] + with_other + text[end:] + "\n")
        except CompoundkinError:
            continue
