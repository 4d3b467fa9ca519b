"""Two mechanisms side by side: what stands for what, and how far apart they come."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files.exchange.drawing import drawing_of
from compoundkin.files.exchange.drawn_mechanism import mechanism_of
from compoundkin.files.exchange.posed_mechanism import posed_mechanism
from tests import catalog

# Ground 10, crank 3, coupler 8, rocker 7, coupler point P.
A, D, CRANK, COUPLER, ROCKER, P = 0j, 10 + 0j, 3.0, 8.0, 7.0, 4 + 3j


def four_bar(crank: float = CRANK, unit: str = "", sign: int = -1, **more: Any) -> ck.Mechanism:
    return ck.Mechanism(
        "Four-bar",
        ck.link("frame", A=A, D=D),
        ck.link("crank", A=0, B=crank),
        ck.link("coupler", B=0, C=COUPLER, P=P),
        ck.link("rocker", D=0, C=ROCKER),
        ck.drive("crank", **more),
        ck.mode(sign, "rocker"),
        unit=unit,
    )


def places(angle: float) -> dict[str, complex]:
    """Its points by plane geometry: the rocker's pin is where two circles meet, above the coupler's line to D."""
    b = CRANK * np.exp(1j * angle)
    to_d = D - b
    along = (abs(to_d) ** 2 + COUPLER**2 - ROCKER**2) / (2 * abs(to_d))
    c = b + (along + 1j * np.sqrt(COUPLER**2 - along**2)) * to_d / abs(to_d)
    return {"A": A, "B": b, "C": c, "D": D, "P": b + P * (c - b) / COUPLER}


def drawn_at(angle: float, scale: float = 1.0, unit: str = "") -> ck.Mechanism:
    """The same drawn with other names and other links first, its driver counted the other way round."""
    names = {"A": "O", "B": "Q", "C": "A", "D": "C", "P": "B"}
    return ck.Mechanism(
        "Drawn",
        ck.link("frame", "C", "O"),
        ck.link("arm", "A", "C"),
        ck.link("plate", "B", "A", "Q"),
        ck.link("wheel", "Q", "O"),
        ck.drive("frame", on="wheel"),
        ck.drawn(**{names[k]: scale * place for k, place in places(angle).items()}),
        unit=unit,
    )


@pytest.mark.parametrize(("angle", "scale", "units"), [
    (1.0, 1.0, ("", "")), (4.0, 0.1, ("mm", "cm")), (2.5, 10.0, ("", "")), (0.3, 1.0, ("mm", "")),
])  # fmt: skip
def test_the_same_with_other_names_zeros_signs_and_units_is_the_same(
    angle: float, scale: float, units: tuple[str, str]
) -> None:
    found = ck.exchange.compare(four_bar(unit=units[0]), drawn_at(angle, scale, units[1]))
    assert found.points == {"A": "O", "D": "C", "B": "Q", "C": "A", "P": "B"}
    assert found.links == {"frame": "frame", "crank": "wheel", "coupler": "plate", "rocker": "arm"}
    assert (found.matched_by, found.poses, found.apart) == ("place", 181, 0)
    assert found.scale == pytest.approx(1 / scale)
    (driver,) = found.drivers
    assert (driver.name, driver.other, driver.sign) == ("crank", "frame", -1)
    assert driver.reach == pytest.approx((0, 2 * np.pi))
    assert found.within(1e-11)
    assert all(abs(length.difference) < 1e-11 for length in found.lengths)
    # and the other way round
    assert ck.exchange.compare(drawn_at(angle, scale, units[1]), four_bar(unit=units[0])).within(1e-11)


def test_what_differs_is_found_where_it_is_largest() -> None:
    """A longer crank, matched by names: as far apart as plane geometry says."""
    found = ck.exchange.compare(four_bar(), four_bar(3.2))
    assert found.matched_by == "name"
    (longer,) = [one for one in found.lengths if abs(one.difference) > 1e-9]
    assert (longer.link, longer.points) == ("crank", ("A", "B"))
    assert longer.difference == pytest.approx(0.2)
    angles = np.linspace(0, 2 * np.pi, 181)
    motions = [ck.solve(m, {"crank": angles}) for m in (four_bar(), four_bar(3.2))]
    for one in found.places:
        off = np.abs(motions[0].points[one.point].position - motions[1].points[one.point].position)
        assert one.distance == pytest.approx(off.max(), rel=1e-9)
        at = one.drives["crank"] if off.max() > 0 else 0.0
        assert np.isclose(off[np.isclose(np.mod(angles - at + 1, 2 * np.pi), 1)], off.max()).any()
    assert found.largest is found.places[0]
    assert not found.within(1e-3)
    assert found.within(0.1)


def test_the_other_assembly_mode_is_not_the_same() -> None:
    found = ck.exchange.compare(four_bar(), four_bar(sign=1))
    assert found.matched_by == "name"
    assert not found.within(0.1)


def test_only_the_range_that_both_have_is_compared() -> None:
    one, other = four_bar(values=ck.deg([20, 100])), four_bar(values=ck.deg([60, 300]))
    (driver,) = ck.exchange.compare(one, other).drivers
    assert np.rad2deg(np.array(driver.reach) + driver.start) == pytest.approx([60, 100])
    assert ck.exchange.compare(four_bar(values=ck.deg([0, 10])), four_bar(values=ck.deg([60, 70]))).poses == 1


def test_what_cannot_be_compared_says_why() -> None:
    loose = ck.Mechanism("Loose", ck.link("frame", A=0, D=9), ck.link("bar", A=0, B=5), ck.link("rod", B=0, C=9))
    assert "not compared" in ck.exchange.compare(four_bar(), loose).verdict
    letters = ck.Mechanism("Letters", ck.link("frame", "A"), ck.link("crank", "A", "B"), ck.drive("crank"))
    other = ck.Mechanism("Other", ck.link("frame", X=50), ck.link("crank", X=0, Y=70), ck.drive("crank"))
    for one in (letters, other):
        found = ck.exchange.compare(four_bar(), one)
        assert found.why
        assert found.largest is None
        assert not found.within(1e9)
        assert found.facts[0].differs
        assert "not compared" in ck.report(found).text()


def test_what_has_no_driver_is_compared_where_it_stands() -> None:
    truss = ck.link("frame", A=0, B=4), ck.link("left", A=0, C=3), ck.link("right", B=0, C=3)
    found = ck.exchange.compare(ck.Mechanism("Truss", *truss), ck.Mechanism("Truss", *truss))
    assert (found.poses, found.within(1e-12)) == (1, True)


def test_the_catalog_as_drawings_is_the_catalog() -> None:
    """Links of letters, other drivers' zeros: what every format makes of a mechanism."""
    for name in ("six-bar", "planetary-train", "five-bar", "scotch-yoke", "oscillating-cylinder", "class-iii-six-bar"):
        mechanism = catalog.mechanism(name)
        drawn = mechanism_of(drawing_of(posed_mechanism(mechanism)), "test").mechanism
        found = ck.exchange.compare(mechanism, drawn)
        assert found.within(1e-9), (name, found)
        assert not found.only_one, name


def test_tracers_of_one_name_that_are_elsewhere_differ() -> None:
    rocker = "ground,crank,R,0,0,tfft\ncrank,rod,R,1,2\nrod,rocker,R,6,4\nrocker,ground,R,5,0\n"
    one, other = (ck.exchange.read(f"{rocker}rod,R,{place}\n").mechanism for place in ("4,5.5", "4.1,5.5"))
    found = ck.exchange.compare(one, other)
    assert found.points["E"] == "E"
    assert found.largest is not None
    assert (found.largest.point, found.largest.distance) == ("E", pytest.approx(0.1))
    assert not found.within()
    assert not ck.exchange.compare(one, one).within(float("nan"))


def test_speeds_that_differ_are_told() -> None:
    one, other = four_bar(unit="mm"), drawn_at(1.0, 0.1, "cm")
    speed = ck.solve(one).drives["crank"].rate.flat[0]
    # driven the other way round: its frame against its wheel
    for times, told in ((-1.0, False), (1.0, True), (-1.01, True)):
        driven = other.replace(ck.drive("frame", on="wheel", speed=times * speed))
        found = ck.exchange.compare(one, driven)
        assert found.drivers[0].other_speed == pytest.approx(-times * speed)
        assert found.within(1e-11)
        assert ("Speeds differ" in ck.report(found).text()) is told


def test_the_report_has_the_numbers_in_every_form() -> None:
    found = ck.exchange.compare(four_bar(unit="mm"), four_bar(3.2, unit="mm"))
    report = ck.report(found)
    data = json.loads(report.json())["sections"]
    assert set(data) == {"about", "structure", "points", "drivers", "dimensions"}
    (table,) = [block for block in data["points"]["blocks"] if block["kind"] == "table"]
    assert found.largest is not None
    assert table["rows"][0][2] == found.largest.distance
    assert f"{found.largest.distance:.6g}" in report.text()
    assert "| crank | A-B | crank | A-B | 3 | 3.2 | 0.2 |" in report.markdown()
    assert "0.2" in found._repr_html_()  # type: ignore[operator]
