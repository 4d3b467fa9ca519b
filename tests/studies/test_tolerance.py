"""Tolerances: slopes against differences of `solve`, worst cases and deviations against closed forms."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

import compoundkin as ck
from compoundkin.studies.samples.random_samples import RandomSample
from compoundkin.studies.tolerances.output_tolerance import SampledOutput

TURN = ck.deg(np.arange(0, 360, 15))
STEP = 1e-4


def changed(mechanism: ck.Mechanism, coordinate: str, step: float) -> ck.Mechanism:
    link, letter, axis = coordinate.split(".")
    points = dict(mechanism.links[link].points)
    points[letter] = points[letter] + step * {"x": 1, "y": 1j}[axis]
    return mechanism.replace(ck.link(link, **points))


def test_slopes_are_differences_of_solve() -> None:
    six_bar = ck.load("six-bar")
    names = ["G.position", "bar.angle", "G.velocity.length", "G.x.stroke", "bar.angle.greatest"]
    tolerances = {"crank.D.x": 0.05, "plate.C": 0.05, "frame.B": 0.1}
    found = ck.tolerance(six_bar, tolerances, names, values=TURN, speed=2.0, clearance={"A": 0.02})
    assert list(found) == ["G.position.x", "G.position.y", *names[1:]]
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
    loose = {"A": 0.05, "B": 0.04, "guide": 0.03}
    found = ck.tolerance(slider_crank(r, rod, e), given, "B.x", values=TURN, clearance=loose, sigmas=2)
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
    worst = np.abs(slopes.T) @ halves + play.sum() * np.abs(slopes[1]) + 0.03 * np.abs(slopes[2])
    assert place.worst == pytest.approx(worst)
    assert (place.high, place.low, place.mean) == tuple(map(pytest.approx, (middle + worst, middle - worst, middle)))
    # at one flank of the guide or at the other
    guide = (0.03 * slopes[2]) ** 2
    parts = [*((slopes.T * halves / 2) ** 2).T, *(play[:, None] ** 2 / 2 * slopes[1] ** 2), guide]
    assert place.deviation == pytest.approx(np.sqrt(sum(parts)))
    names = [*given, "clearance A", "clearance B", "clearance guide"]
    assert list(place.contributions) == names
    assert np.array(list(place.contributions.values())) == pytest.approx(np.array(parts) / sum(parts))


def test_a_guide_through_a_point_has_an_offset_of_none() -> None:
    """It is not written, and may be off all the same: as by the offset that is written."""
    shaper = ck.load("crank-shaper")
    for asked in ({"clearance": {"slot": 0.03}}, {"tolerances": {"slot.offset": 0.03}}):
        found = ck.tolerance(shaper, **{"tolerances": {}, **asked}, outputs="ram.value", count=800)["ram.value"]
        slot = next(pair for pair in shaper.written_pairs if pair.name == "slot")
        fore, back = (ck.solve(shaper.replace(replace(slot, offset=sign * STEP))) for sign in (1, -1))
        slope = (fore.pairs["ram"].value - back.pairs["ram"].value) / (2 * STEP)
        assert found.worst == pytest.approx(0.03 * np.abs(slope), rel=1e-6, abs=1e-9)
    assert "ram.value" in ck.tolerance(shaper, {"crank.A": 0.1}, "ram.value", count=800)


def test_a_four_bar_has_the_mechanical_error_of_the_textbooks() -> None:
    """By its loop, differentiated: R. S. Hartenberg, J. Denavit, Kinematic Synthesis of Linkages, 1964, on mechanical
    errors; R. E. Garrett, A. S. Hall, Trans. ASME J. Eng. Ind. 91 (1969) 198-202.

    a cos(theta - psi) da + db = cos(psi) dd + cos(phi - psi) dc - c sin(phi - psi) dphi. A play at any of the pins
    shifts an end of the coupler, and counts along it.
    """
    a, b, c, d = 2.0, 5.0, 4.0, 5.5
    four_bar = ck.Mechanism(
        "Four-bar", ck.link("frame", A=0, D=d), ck.link("crank", A=0, B=a), ck.link("coupler", B=0, C=b),
        ck.link("rocker", D=0, C=c), ck.drive("crank"), ck.mode(-1, "rocker"),
    )  # fmt: skip
    play, names = 0.004, ["crank.B.x", "coupler.C.x", "rocker.C.x", "frame.D.x"]
    given = dict(zip(names, (0.01, 0.02, 0.03, 0.04), strict=True))
    found = ck.tolerance(four_bar, given, "rocker.angle", values=TURN, clearance=dict.fromkeys("ABCD", play))
    motion = ck.solve(four_bar, TURN)
    psi, phi = (motion.links[link].angle for link in ("coupler", "rocker"))
    transmission = c * np.sin(phi - psi)
    slopes = np.array([-np.cos(TURN - psi), -np.ones_like(psi), np.cos(phi - psi), np.cos(psi)]) / transmission
    one = found["rocker.angle"]
    assert np.array([one.slopes[name] for name in names]) == pytest.approx(slopes)
    for pin in "ABCD":
        assert one.worst_parts[f"clearance {pin}"] == pytest.approx(play / np.abs(transmission))
    halves = np.array(list(given.values()))
    assert one.worst == pytest.approx(halves @ np.abs(slopes) + 4 * play / np.abs(transmission))
    assert one.deviation**2 == pytest.approx((halves / 3) ** 2 @ slopes**2 + 2 * (play / transmission) ** 2)


@pytest.mark.full
def test_a_play_is_the_same_on_either_link() -> None:
    """What two links are off at their pin depends on neither, but for the axes that it is told in."""
    six_bar = ck.load("six-bar")
    for pin, links in {"A": ("plate", "rocker"), "E": ("frame", "crank")}.items():
        one, other = (
            ck.tolerance(six_bar, {}, "bar.angle", values=TURN, clearance={f"{link}.{pin}": 0.02}, count=800)[
                "bar.angle"
            ]
            for link in links
        )
        assert one.worst == pytest.approx(other.worst, rel=1e-9)
        assert one.deviation == pytest.approx(one.worst / np.sqrt(2), rel=1e-12)


def test_figures_have_tolerances_too() -> None:
    found = ck.tolerance(ck.load("slider-crank"), {"crank.A.x": 0.001}, "stroke.stroke")["stroke.stroke"]
    assert (found.is_course, found.nominal, found.worst) == (False, pytest.approx(0.24), pytest.approx(0.002))


@pytest.mark.full
def test_random_designs_agree_with_the_slopes_where_tolerances_are_small() -> None:
    six_bar = ck.load("six-bar")
    names = ["G.position", "bar.angle", "G.velocity.length", "G.x.stroke"]
    given = {"crank.D.x": 1e-3, "plate.C": (-2e-3, 0), "frame.B": ck.around(six_bar.links["frame"].points["B"], 1e-3)}
    found = ck.tolerance(six_bar, given, names, values=TURN, speed=2.0, count=8000, seed=3, percentiles=(2, 50, 98))
    for name, one in found.items():
        sample = one.sample
        # the means of many poses of one sample hang together, so that few of them are more than 4 errors off
        assert np.max(np.abs(sample.mean - one.mean) / sample.mean_error) < 4.5, name
        assert np.max(np.abs(sample.deviation - one.deviation) / sample.deviation_error) < 4.5, name
        # several sources of about the same size make a distribution that is nearly normal
        normal = one.mean + np.multiply.outer(stats.norm.ppf([0.02, 0.5, 0.98]), one.deviation)
        assert np.max(np.abs(sample.percentiles - normal) / sample.percentile_errors) < 6, name
        assert np.all((sample.values > one.low - one.worst) & (sample.values < one.high + one.worst)), name


def test_random_designs_are_those_of_solve() -> None:
    """Also where tolerances are not small; a play displaces one link's point by just its radius."""
    six_bar = ck.load("six-bar")
    given = {"plate.C.x": stats.norm(12, 0.5), "crank.D.x": 0.3}
    asked = {"values": TURN, "speed": 2.0, "clearance": {"plate.C": 0.2}, "count": 40, "percentiles": [50]}
    found = ck.tolerance(six_bar, given, ["bar.angle", "G.velocity.length", "G.x.greatest", "G.x.stroke"], **asked)
    own, errors = six_bar.links["plate"].points["C"], {one.name: one for one in found.sources}
    sample = RandomSample(40, 0).units(3, range(40))
    x = stats.norm(12, 0.5).ppf(sample[:, 0])
    play = 0.2 * np.exp(2j * np.pi * sample[:, 2])
    assert errors["clearance plate.C"].errors(sample[:, 2:]) == pytest.approx(np.array([play.real, play.imag]))
    for row in (0, 7, 39):
        D = six_bar.links["crank"].points["D"] + 0.1 * stats.norm.ppf(sample[row, 1])
        plate = {**six_bar.links["plate"].points, "C": x[row] + 1j * own.imag + play[row]}
        crank = {**six_bar.links["crank"].points, "D": D}
        motion = ck.solve(six_bar.replace(ck.link("plate", **plate), ck.link("crank", **crank)), TURN, speed=2.0)
        for name, one in found.items():
            assert one.sample.values[row] == pytest.approx(ck.quantity(motion, name).values, rel=1e-9), name


def test_a_distribution_has_its_mean_deviation_and_ends() -> None:
    crank = slider_crank(50.0, 120.0, 0.0)
    for given, low, high, mean, deviation in (
        (ck.around(50.1, 0.2), -0.1, 0.3, 0.1, 0.2 / np.sqrt(3)),
        (stats.triang(0.25, 49.9, 0.4), -0.1, 0.3, 0.2 / 3, 0.4 * np.sqrt((1 + 0.25**2 - 0.25) / 18)),
        (stats.norm(50.2, 0.1), -0.2, 0.6, 0.2, 0.1),
    ):
        one = ck.tolerance(crank, {"crank.A.x": given}, "B.x", values=0.0, sigmas=4, count=800)["B.x"]
        expected = [[170 + low], [170 + high], [170 + mean], [deviation]]
        assert np.array([one.low, one.high, one.mean, one.deviation]) == pytest.approx(np.array(expected), rel=1e-6)


def test_standard_errors_are_those_of_many_samples() -> None:
    samples = [SampledOutput(np.random.default_rng(k).gamma(2.0, size=2000), (1, 50, 99)) for k in range(300)]
    for found, told in (
        ([one.mean for one in samples], [one.mean_error for one in samples]),
        ([one.deviation for one in samples], [one.deviation_error for one in samples]),
        ([one.percentiles for one in samples], [one.percentile_errors for one in samples]),
    ):
        assert np.mean(told, axis=0) == pytest.approx(np.std(found, axis=0), rel=0.15)


def test_designs_that_cannot_be_assembled_are_counted() -> None:
    """Coupler and rocker must reach: the longest diagonal of crank and frame is 5."""
    bar = ck.Mechanism(
        "Rocker", ck.link("frame", A=0, D=4), ck.link("crank", A=0, B=1), ck.link("coupler", B=0, C=3),
        ck.link("rocker", D=0, C=2.05), ck.drive("crank"), ck.mode(1, "rocker"),
    )  # fmt: skip
    with pytest.warns(ck.errors.UnassembledPoses, match="of 4096 random designs cannot be assembled") as told:
        found = ck.tolerance(bar, {"crank.B.x": 0.06, "rocker.C.x": 0.06}, "rocker.angle", values=TURN)
    assert len(told) == 1
    # crank 1 +- 0.02, rocker 2.05 +- 0.02: the sum of the crank's error and the rocker's lack is beyond 0.05
    expected = stats.norm.sf(0.05 / (0.02 * np.sqrt(2)))
    assert found.unassembled / 4096 == pytest.approx(expected, abs=5 * np.sqrt(expected / 4096))
    assert found["rocker.angle"].sample.count == 4096 - found.unassembled
    told = pytest.raises(ck.errors.NotAssembled, match="values: 3 poses of the mechanism itself cannot be assembled")
    with told, pytest.warns(ck.errors.UnassembledPoses):
        ck.tolerance(bar.replace(ck.link("rocker", D=0, C=1.9)), {"crank.B.x": 0.06}, "rocker.angle", values=TURN)


def test_slopes_that_there_are_not_are_told() -> None:
    """A parallelogram at its change point: the rocker may turn either way."""
    bar = ck.Mechanism(
        "Parallelogram", ck.link("frame", A=0, D=4), ck.link("crank", A=0, B=1), ck.link("coupler", B=0, C=4),
        ck.link("rocker", D=0, C=1), ck.drive("crank"), ck.drawn(A=0, B=1j, C=4 + 1j, D=4),
    )  # fmt: skip
    with pytest.warns(ck.errors.FewDigits, match=r"rocker.angle has no slopes at 1 of 3 poses"):
        found = ck.tolerance(bar, {"frame.A.y": 1e-6}, "rocker.angle", values=ck.deg([160.0, 180.0, 200.0]), count=800)
    assert np.isnan(found["rocker.angle"].deviation).tolist() == [False, True, False]


def test_angles_are_counted_by_the_nearest_turn() -> None:
    press = slider_crank(50.0, 120.0, 0.0).replace(ck.link("rod", A=0, B=-120))
    rod = ck.tolerance(press, {"guide.offset": 0.2}, "rod.angle", values=ck.deg([180.0]))
    for one in rod.values():
        assert abs(one.nominal) == pytest.approx(np.pi)
        assert one.sample.deviation == pytest.approx(0.2 / 3 / 120, rel=0.05)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"tolerances": {"plate.Q": 0.1}}, "tolerances.plate.Q: it has no such dimension.*plate"),
        (
            {"tolerances": {"plate.C": -0.1}},
            r"tolerances.plate.C: the tolerance -0.1 has a lower limit above the upper; give 0.1",
        ),
        ({"tolerances": {"plate.C": (0.1, -0.1)}}, r"lower limit above the upper; give \(-0.1, 0.1\)"),
        ({"tolerances": {"plate.C": "tight"}}, "tolerances.plate.C: a text is no number"),
        ({"tolerances": {"plate.C": 0.1, "plate.C.x": 0.1}}, "tolerances.plate.C.x: 'plate.C' has a tolerance"),
        ({"tolerances": {}}, "tolerances: nothing has a tolerance"),
        ({"outputs": []}, "outputs: no output is named"),
        ({"outputs": "G.postion"}, "did you mean"),
        ({"clearance": {"Q": 0.1}}, "clearance.Q: there is no such pin, slot or guide"),
        ({"clearance": {"rocker.D": 0.1}}, "clearance.rocker.D: there is no such pin, slot or guide; did you mean"),
        ({"clearance": {"block.C": 0.1}}, "clearance.block.C: another pair is at C on block.*'plate.C'"),
        ({"clearance": {"A": -1}}, "clearance.A: -1 is not a clearance"),
        ({"sigmas": 0}, "sigmas: 0 is no number"),
        ({"count": 700}, "count: 700 random designs are too few for percentile 0.135 or 99.865; count=741 or more"),
        ({"percentiles": (0, 50)}, "percentiles: .* are no percentiles"),
        ({"values": [[0.1], [0.2]]}, r"values: they are of several motions, \(2, 1\)"),
        ({"seed": -1}, "seed: -1 is no seed"),
        (
            {"tolerances": {"plate.C": stats.norm(12, 1)}},
            "tolerances.plate.C: its values are numbers, and the dimension",
        ),
        ({"tolerances": {"plate.C.x": ck.around((1, 2), 1)}}, "tolerances.plate.C.x: its values are points"),
    ],
)
def test_what_is_wrong_is_told(given: dict[str, object], told: str) -> None:
    right = {"mechanism": ck.load("six-bar"), "tolerances": {"plate.C": 0.1}, "outputs": "bar.angle"}
    with pytest.raises(ck.errors.CompoundkinError, match=told):
        ck.tolerance(**{**right, **given})


def test_tables_of_sources_and_of_poses(tmp_path: Path) -> None:
    names = ["rod.angle", "B.x", "B.x.stroke"]
    found = ck.tolerance(
        slider_crank(50.0, 120.0, 10.0),
        {"crank.A.x": 0.1, "guide.angle": 0.01},
        names,
        values=TURN,
        clearance={"A": 0.05},
    )
    told = "('rod.angle', 'B.x', 'B.x.stroke') by ('crank.A.x', 'guide.angle', 'clearance A')"
    assert repr(found) == f"ToleranceAnalysis('Slider-crank': {told})"
    table = found.table()
    assert table["source"].values.tolist() == ["crank.A.x", "guide.angle", "clearance A"]
    assert table["unit"].values.tolist() == ["mm", "rad", "mm"]
    assert table["upper"].values.tolist() == [0.1, 0.01, 0.05]
    for name, one in found.items():
        pose = np.argmax(one.deviation) if one.is_course else ()
        assert sum(table[f"{name}.worst"].values) == pytest.approx(np.asarray(one.worst)[pose])
        assert np.linalg.norm(table[f"{name}.deviation"].values) == pytest.approx(np.asarray(one.deviation)[pose])
        assert sum(table[f"{name}.share"].values) == pytest.approx(1)
    for suffix in ("csv", "json", "npz", "parquet"):
        ck.save(found, tmp_path / f"shares.{suffix}")
    first, _, guide, _ = (tmp_path / "shares.csv").read_text().splitlines()
    assert first.startswith(
        "source,lower,upper,unit,rod.angle.worst [deg],rod.angle.deviation [deg],rod.angle.share,B.x"
    )
    assert guide.startswith(f"guide.angle,{-np.rad2deg(0.01)},{np.rad2deg(0.01)},deg,")
    bands = found.bands()
    assert bands.names[:4] == ("crank.value", "rod.angle", "rod.angle.low", "rod.angle.high")
    assert np.array_equal(bands["B.x.percentile_99.865"].values, found["B.x"].sample.percentiles[2])
    ck.save(found.bands("B.x"), tmp_path / "bands.csv")
    assert len((tmp_path / "bands.csv").read_text().splitlines()) == 1 + len(TURN)
    with pytest.raises(ck.errors.InvalidInput, match=r"B.x.stroke: it is a figure of the whole motion"):
        found.bands("B.x.stroke")
    with pytest.raises(ck.errors.UnknownName, match=r"B.y: there is no such output"):
        found.table("B.y")


def test_the_page_prints_what_it_shows(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    page = (Path(__file__).parents[2] / "docs" / "tolerances.md").read_text("utf-8")
    exec("\n".join(re.findall(r"```python\n(.*?)```", page, re.DOTALL)), {})
    assert capsys.readouterr().out == "".join(re.findall(r"```text\n(.*?)```", page, re.DOTALL))


def test_pins_of_three_links_want_to_know_which_are_loose() -> None:
    press = ck.load("toggle-press")
    with pytest.raises(ck.errors.InvalidInput, match=r"3 links meet there.*BD.B, CB.B, AB.B"):
        ck.tolerance(press, {}, "D.y", clearance={"B": 0.02})
    found = ck.tolerance(press, {}, "D.y", clearance={"BD.B": 0.02, "CB.B": 0.02})
    assert [source.name for source in found.sources] == ["clearance BD.B", "clearance CB.B"]


def test_designs_whose_wheels_do_not_fit_are_left_out() -> None:
    """Errors of the distance of axes to 3 sigmas of 0.0007 mm, and 0.00052 mm fit: by the normal distribution."""
    train = ck.load("planetary-train")
    share = 2.0 * stats.norm.sf(52e-5 / (1.0 + 1e-5) / (0.0007 / 3.0))
    with pytest.warns(ck.errors.UnassembledPoses, match=r"planet in annulus does not fit in \d+"):
        found = ck.tolerance(train, {"arm.P.x": 0.0007}, "Q.x", values=[0.0, 1.0], count=4096)
    assert abs(found.unassembled / 4096 - share) < 4.0 * np.sqrt(share / 4096)
    with pytest.raises(ck.errors.NotAssembled, match=r"random designs .* \(planet in annulus does not fit in \d+\)"):
        ck.tolerance(train, {"arm.P.x": 50.0}, "Q.x", values=[0.0, 1.0], count=1024)
