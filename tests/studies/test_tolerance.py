"""Tolerances: slopes against differences of `solve`, worst cases and deviations against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck

TURN = ck.deg(np.arange(0, 360, 15))
STEP = 1e-4


def changed(mechanism: ck.Mechanism, coordinate: str, step: float) -> ck.Mechanism:
    link, letter, axis = coordinate.split(".")
    points = dict(mechanism.links[link].points)
    points[letter] = points[letter] + step * {"x": 1, "y": 1j}[axis]
    return mechanism.replace(ck.link(link, **points))


def test_slopes_are_differences_of_solve() -> None:
    six_bar = ck.catalog.load_named("six-bar")
    names = ["G.position", "bar.angle", "G.velocity.length"]
    tolerances = {"crank.D.x": 0.05, "plate.C": 0.05, "frame.B": 0.1}
    found = ck.tolerance(six_bar, tolerances, names, values=TURN, speed=2.0, clearance={"A": 0.02})
    assert list(found) == ["G.position.x", "G.position.y", "bar.angle", "G.velocity.length"]
    coordinates = ["crank.D.x", "plate.C.x", "plate.C.y", "frame.B.x", "frame.B.y", "rocker.A.x", "rocker.A.y"]
    assert set(found["bar.angle"].slopes) == set(coordinates)
    for by in coordinates:
        fore, back = (ck.solve(changed(six_bar, by, sign * STEP), TURN, speed=2.0) for sign in (1, -1))
        for name, one in found.items():
            difference = (ck.quantity(fore, name).values - ck.quantity(back, name).values) / (2 * STEP)
            assert np.abs(one.slopes[by] - difference).max() < 1e-6 * max(np.abs(difference).max(), 1e-3), (name, by)


def slider_crank(crank: float, rod: float, offset: float) -> ck.Mechanism:
    return ck.Mechanism(
        "Slider-crank",
        ck.link("frame", O=0),
        ck.link("crank", O=0, A=crank),
        ck.link("rod", A=0, B=rod),
        ck.link("piston", B=0),
        ck.slide("piston", on="frame", at="B", through="O", angle=0, offset=offset, name="guide"),
        ck.drive("crank"),
        unit="mm",
    )


def test_a_slider_crank_has_its_closed_form() -> None:
    """Place x = r cos + sqrt(l^2 - (r sin - e)^2), with its derivatives by hand; each radius of play once."""
    r, rod, e = 50.0, 120.0, 10.0
    given = {"crank.A.x": 0.1, "rod.B.x": (-0.3, 0.1), "guide.offset": 0.2}
    found = ck.tolerance(slider_crank(r, rod, e), given, "B.x", values=TURN, clearance={"A": 0.05, "B": 0.04}, sigmas=2)
    place = found["B.x"]
    sine, cosine = np.sin(TURN), np.cos(TURN)
    across = r * sine - e
    along = np.sqrt(rod**2 - across**2)
    slopes = np.array([cosine - across * sine / along, rod / along, across / along])
    # a play moves an end of the rod: along it alone, which is seen as a change of its length
    halves, play = np.array([0.1, 0.2, 0.2]), np.array([0.05, 0.04])
    assert place.nominal == pytest.approx(r * cosine + along)
    # the middle of -0.3 and 0.1 is at -0.1
    middle = r * cosine + along - 0.1 * slopes[1]
    worst = np.abs(slopes.T) @ halves + play.sum() * np.abs(slopes[1])
    assert place.worst == pytest.approx(worst)
    assert (place.high, place.low, place.mean) == tuple(map(pytest.approx, (middle + worst, middle - worst, middle)))
    parts = [*((slopes.T * halves / 2) ** 2).T, *(play[:, None] ** 2 / 2 * slopes[1] ** 2)]
    assert place.deviation == pytest.approx(np.sqrt(sum(parts)))
    names = [*given, "clearance A", "clearance B"]
    assert list(place.contributions) == names
    assert np.array(list(place.contributions.values())) == pytest.approx(np.array(parts) / sum(parts))


def test_a_play_is_the_same_on_either_link() -> None:
    """What two links are off at their pin depends on neither, but for the axes that it is told in."""
    six_bar = ck.catalog.load_named("six-bar")
    for pin, links in {"D": ("crank", "plate"), "A": ("plate", "rocker"), "E": ("frame", "crank")}.items():
        one, other = (
            ck.tolerance(six_bar, {}, "bar.angle", values=TURN, clearance={f"{link}.{pin}": 0.02})["bar.angle"]
            for link in links
        )
        assert one.worst == pytest.approx(other.worst, rel=1e-9)
        assert one.deviation == pytest.approx(one.worst / np.sqrt(2), rel=1e-12)


def test_figures_have_tolerances_too() -> None:
    found = ck.tolerance(ck.catalog.load_named("slider-crank"), {"crank.A.x": 0.001}, "stroke.stroke")["stroke.stroke"]
    assert (found.is_course, found.nominal, found.worst) == (False, pytest.approx(0.24), pytest.approx(0.002))


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"tolerances": {"plate.Q": 0.1}}, "tolerances.plate.Q: it has no such dimension.*plate"),
        ({"tolerances": {"plate.C": -0.1}}, r"tolerances.plate.C: the tolerance -0.1 is less than nothing; give 0.1"),
        ({"tolerances": {"plate.C": (0.1, -0.1)}}, r"less than nothing; give \(-0.1, 0.1\)"),
        ({"tolerances": {"plate.C": "tight"}}, "tolerances.plate.C: a text is no number"),
        ({"tolerances": {"plate.C": 0.1, "plate.C.x": 0.1}}, "tolerances.plate.C.x: 'plate.C' has a tolerance"),
        ({"tolerances": {}}, "tolerances: nothing has a tolerance"),
        ({"outputs": []}, "outputs: no output is named"),
        ({"outputs": "G.postion"}, "did you mean"),
        ({"clearance": {"Q": 0.1}}, "clearance.Q: there is no such pin"),
        ({"clearance": {"rocker.D": 0.1}}, "clearance.rocker.D: there is no such pin; did you mean"),
        ({"clearance": {"block.C": 0.1}}, "clearance.block.C: another pair is at C on block.*'plate.C'"),
        ({"clearance": {"A": -1}}, "clearance.A: -1 is no clearance"),
        ({"sigmas": 0}, "sigmas: 0 is no number"),
    ],
)
def test_what_is_wrong_is_told(given: dict[str, object], told: str) -> None:
    right = {"mechanism": ck.catalog.load_named("six-bar"), "tolerances": {"plate.C": 0.1}, "outputs": "bar.angle"}
    with pytest.raises(ck.errors.CompoundkinError, match=told):
        ck.tolerance(**{**right, **given})


def test_pins_of_three_links_want_to_know_which_are_loose() -> None:
    press = ck.catalog.load_named("toggle-press")
    with pytest.raises(ck.errors.InvalidInput, match=r"3 links meet there.*BD.B, CB.B, AB.B"):
        ck.tolerance(press, {}, "D.y", clearance={"B": 0.02})
    found = ck.tolerance(press, {}, "D.y", clearance={"BD.B": 0.02, "CB.B": 0.02})
    assert [source.name for source in found.sources] == ["clearance BD.B", "clearance CB.B"]
