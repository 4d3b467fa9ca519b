"""Force balance: Berkof and Lowen's conditions, mechanisms of the catalog, and what cannot be balanced."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from tests import catalog
from tests.dynamics.test_equivalent_inertia import UNITS, slider_crank

TURN = np.deg2rad(np.arange(0.0, 361.0, 5.0))


def four_bar(crank: complex, rocker: complex) -> ck.Mechanism:
    """Return the linkage of balanced_four_bar, of the reference, with its mass centres of crank and rocker."""
    masses = (
        ck.mass("crank", 1.0, at=crank, inertia=0.002),
        ck.mass("coupler", 0.4, at=(0.06893654271085456, 0.012155372436685125), inertia=0.001),
        ck.mass("rocker", 1.5, at=rocker, inertia=0.004),
    )
    links = (ck.link("frame", O=(0, 0), C=(0.14, 0)), ck.link("crank", O=(0, 0), A=(0.05, 0)),
             ck.link("coupler", A=(0, 0), B=(0.15, 0)), ck.link("rocker", C=(0, 0), B=(0.12, 0)))  # fmt: skip
    return ck.Mechanism("Four-bar", *links, ck.drive("crank"), *masses, units=UNITS)


def shaking(mechanism: ck.Mechanism, **given: Any) -> Any:
    """Return the greatest shaking force by the reverse pass, in parts of what a link alone would do."""
    motion = ck.solve(mechanism, **given)
    forces = ck.force_analysis(motion)
    largest = max(np.abs(np.asarray(one.force)).max() for one in forces.pairs.values())
    return np.abs(np.asarray(forces.shaking.force)).max() / largest


def test_a_four_bar_is_balanced_by_the_conditions_of_berkof_and_lowen() -> None:
    """m2 c2 = -m3 a2 (1 - p3 / a3) and m4 c4 = -m3 p3 a4 / a3; figures of case balanced_four_bar of the reference."""
    motion = ck.solve(four_bar(0.02 + 0j, 0.05 + 0j), TURN, speed=100)
    found = ck.figures.counterweights(motion, mass=0.5, about="O")
    assert found.is_full
    assert not found.unreached
    crank, rocker = found.counterweights
    np.testing.assert_allclose(crank.moment, -0.010808460971886058 + 0.0016207163248913498j - 0.02, rtol=1e-13)
    wanted = 1.5 * (-0.014706462444982306 - 0.00259314611982616j - 0.05)
    np.testing.assert_allclose(rocker.moment, wanted, rtol=1e-13)
    np.testing.assert_allclose(crank.at * 0.5, crank.moment, rtol=1e-14)
    assert shaking(found.mechanism, values=TURN, speed=100) < 1e-14
    force, moment, effort = found.before
    exact = ck.force_analysis(motion)
    np.testing.assert_allclose(force.greatest, np.abs(np.asarray(exact.shaking.force)).max(), rtol=1e-2)
    np.testing.assert_allclose(moment.greatest, np.abs(exact.shaking.moment_about("O")).max(), rtol=1e-2)
    np.testing.assert_allclose(effort.rms, ck.figures.drive_figures(exact).rms_effort, rtol=1e-9)
    # the price: shaking moment and torque rise
    assert all(new.greatest > old.greatest for old, new in zip(found.before[1:], found.after[1:], strict=True))
    assert "Full force balance by 2 counterweights." in found.text()
    assert "shaking moment, greatest [N m]" in found.text()


def test_a_balanced_linkage_needs_no_counterweight() -> None:
    balanced = four_bar(-0.010808460971886058 + 0.0016207163248913498j, -0.014706462444982306 - 0.00259314611982616j)
    found = ck.figures.counterweights(ck.solve(balanced, TURN, speed=100))
    assert (found.is_full, found.counterweights) == (True, ())


def heavy(name: str) -> ck.Mechanism:
    """Return a mechanism of the catalog with random masses off all pins."""
    mechanism, rng = catalog.mechanism(name), np.random.default_rng(7)
    size = ck.solve(mechanism, order=0).size
    masses = [
        ck.mass(link, float(rng.uniform(0.5, 2.0)), at=complex(*rng.uniform(-0.2, 0.2, 2)) * size, inertia=size**2 / 9)
        for link in mechanism.links
        if link != "frame" and link not in mechanism.auxiliary_links
    ]
    return mechanism.replace(*masses, units=UNITS)


@pytest.mark.parametrize(("name", "count"), [("six-bar", 3), ("stephenson-iii", 3), ("andrews-squeezer", 4)])
def test_linkages_of_n_links_take_half_as_many_counterweights(name: str, count: int) -> None:
    """Six links take three, eight take four: Berkof and Lowen 1969, Walker and Oldham 1978."""
    mechanism = heavy(name)
    found = ck.figures.counterweights(mechanism)
    assert found.is_full
    assert len(found.counterweights) == count
    assert shaking(found.mechanism) < 1e-12


def test_links_that_turn_alike_share_a_counterweight() -> None:
    """In a parallelogram the coupler does not turn, and both cranks do as one: the motion shows it."""
    links = (ck.link("frame", O=(0, 0), C=(4, 0)), ck.link("crank", O=(0, 0), A=(1, 0)),
             ck.link("coupler", A=(0, 0), B=(4, 0)), ck.link("rocker", C=(0, 0), B=(1, 0)))  # fmt: skip
    masses = ck.mass("crank", 1.0, at=(0.4, 0)), ck.mass("coupler", 2.0, at=(1, 1)), ck.mass("rocker", 1.0, at=(0.3, 0))
    mechanism = ck.Mechanism("m", *links, ck.drive("crank"), *masses, ck.drawn(A=(0, 1), B=(4, 1)), units=UNITS)
    found = ck.figures.counterweights(ck.solve(mechanism, {"crank": TURN + 0.3}))
    assert found.is_full
    (only,) = found.counterweights
    np.testing.assert_allclose(only.moment, -(0.4 + 2.0 + 0.3), rtol=1e-9)


def test_a_slider_crank_is_balanced_wholly_by_its_rod_or_half_by_its_crank() -> None:
    """Half of what goes to and fro is best where the piston's first harmonic is the crank's radius: always in line."""
    masses = ck.mass("crank", 2.0, at=(0.01, 0)), ck.mass("rod", 0.8, at=(0.06, 0.01)), ck.mass("piston", 0.5)
    motion = ck.solve(slider_crank(*masses), TURN, speed=150)
    whole = ck.figures.counterweights(motion, radius={"crank": 0.03, "rod": 0.08}, disc=0.01)
    assert whole.is_full
    crank, rod = whole.counterweights
    np.testing.assert_allclose(rod.moment, -(0.8 * (0.06 + 0.01j) + 0.5 * 0.2), rtol=1e-13)
    np.testing.assert_allclose(crank.moment, -(0.02 + 0.05 * (0.8 + 0.5 + rod.mass)), rtol=1e-13)
    np.testing.assert_allclose(rod.inertia, rod.mass * 0.01**2 / 2)
    assert shaking(whole.mechanism, values=TURN, speed=150) < 1e-13
    least = ck.figures.counterweights(motion, "crank")
    half = ck.figures.counterweights(motion, fraction=0.5)
    assert not least.is_full
    assert not half.is_full
    np.testing.assert_allclose(
        half.counterweights[0].moment,
        -(0.02 + 0.05 * (0.8 * 0.7 + 0.5 * (0.24 + 0.5)) - 0.05j * 0.8 * 0.05 * 0.5),
        rtol=1e-12,
    )
    in_line = ck.solve(slider_crank(ck.mass("crank", 2.0, at=(0.01, 0)), ck.mass("piston", 0.5)), TURN, speed=150)
    best, halved = (ck.figures.counterweights(in_line, **given) for given in ({"links": "crank"}, {"fraction": 0.5}))
    np.testing.assert_allclose(best.counterweights[0].moment, halved.counterweights[0].moment, rtol=1e-12)
    assert best.after[0].rms < 0.6 * best.before[0].rms


def test_what_only_slides_cannot_be_balanced_and_is_named() -> None:
    """Tepper and Lowen: a yoke that only slides has no chain of pins to the frame; half its mass is the best."""
    links = (ck.link("frame", O=0), ck.link("crank", O=0, A=1), ck.link("block", A=0), ck.link("yoke", Y=0))
    slides = (
        ck.slide("yoke", on="frame", through="O", angle=0),
        ck.slide("block", on="yoke", through="Y", angle=np.pi / 2),
    )
    mechanism = ck.Mechanism("m", *links, *slides, ck.drive("crank"), ck.mass("yoke", 3.0), units=UNITS)
    found = ck.figures.counterweights(ck.solve(mechanism, TURN, speed=2))
    assert not found.is_full
    assert found.unreached == ("yoke",)
    np.testing.assert_allclose(found.counterweights[0].moment, -1.5, rtol=1e-12)
    assert "does not exist: no chain of pins alone joins yoke to the frame" in found.text()
    np.testing.assert_allclose(found.after[0].greatest, 6.0, rtol=1e-12)


def test_what_is_wrong_is_said() -> None:
    mechanism = slider_crank(ck.mass("piston", 0.5))
    motion = ck.solve(mechanism, TURN)
    cases: list[tuple[dict[str, Any], str]] = [
        ({"links": "piston", "mass": 1.0, "radius": 1.0}, "mass and radius are both given"),
        ({"links": "rodd"}, "did you mean 'rod'"),
        ({"mass": -1.0}, "is no mass of a counterweight"),
        ({"about": "Q"}, "the frame has no point 'Q'"),
    ]
    for given, told in cases:
        with pytest.raises(ck.errors.CompoundkinError, match=told):
            ck.figures.counterweights(motion, **given)
    with pytest.raises(ck.errors.InvalidInput, match="only a slider-crank"):
        ck.figures.counterweights(ck.solve(four_bar(0j, 0j), TURN), fraction=0.5)
    with pytest.raises(ck.errors.InvalidInput, match="only one design"):
        ck.figures.counterweights(ck.solve(mechanism, np.tile(TURN, (2, 1))))
