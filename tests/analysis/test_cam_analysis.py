"""Pressure angle, radii of curvature, sliding and warnings of cams against formulas from books."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from tests.model.test_profiles import mechanism

RISE = ck.laws.program(
    ck.laws.rise(30, ck.deg(120)), ck.laws.dwell(ck.deg(60)), ck.laws.fall(30, ck.deg(120)), ck.laws.dwell(ck.deg(60))
)
SWING = ck.laws.program(
    ck.laws.rise(ck.deg(25), ck.deg(120)),
    ck.laws.dwell(ck.deg(60)),
    ck.laws.fall(ck.deg(25), ck.deg(120)),
    ck.laws.dwell(ck.deg(60)),
)


def analysed(cam: Any, angles: Any, speed: float = 1.0) -> ck.results.CamAnalysis:
    motion = ck.solve(mechanism(cam), {"cam": angles}, speed=speed)
    return ck.figures.cam_analysis(motion, motion.mechanism.written_pairs[-1].name)


def test_pressure_angle_of_an_offset_roller() -> None:
    """tan(phi) = (S' - e) / (S + y0): E. Soylemez, Mechanisms, section 8.5."""
    for offset in (12.0, -12.0):
        for clockwise in (False, True):
            cam = ck.profiles.synthesise(
                RISE, base=40, follower="roller", roller=10, offset=offset, clockwise=clockwise
            )
            angles = ck.deg(np.array([0, 30, 60, 90, 120])) * (-1 if clockwise else 1)
            found = analysed(cam, angles)
            u = np.array([0, 0.25, 0.5, 0.75, 1.0])
            s = 30 * (u - np.sin(2 * np.pi * u) / (2 * np.pi))
            rate = 30 * (1 - np.cos(2 * np.pi * u)) / ck.deg(120)
            # the follower's axis is on the side that lowers the pressure angle of the rise where the cam turns away
            sense = 1 if clockwise else -1
            expected = np.arctan((rate - sense * offset) / (s + np.sqrt(50**2 - 12**2)))
            assert np.max(np.abs(np.abs(found.pressure_angle) - np.abs(expected))) < 1e-12
            assert np.allclose(found.pressure_angle, -sense * expected, atol=1e-12)


def test_greatest_pressure_angles() -> None:
    angles = ck.deg(np.linspace(0, 120, 12_001))
    best = analysed(ck.profiles.synthesise(RISE, base=40, follower="roller", roller=10, offset=-12), angles)
    assert abs(np.rad2deg(best.greatest_pressure_angle) - 14.870873) < 1e-6
    assert not best.warnings
    worst = analysed(ck.profiles.synthesise(RISE, base=40, follower="roller", roller=10, offset=12), angles)
    u = np.linspace(0, 1, 120_001)
    s = 30 * (u - np.sin(2 * np.pi * u) / (2 * np.pi)) + np.sqrt(50**2 - 12**2)
    greatest = np.rad2deg(np.max(np.arctan((30 * (1 - np.cos(2 * np.pi * u)) / ck.deg(120) + 12) / s)))
    (warning,) = worst.warnings
    assert warning == f"The pressure angle reaches {greatest:.4g} degrees, more than the customary 30."
    # an oscillating roller, centre distance 80, arm 60: two ways of turning
    for side, greatest in ((1, 18.843680), (-1, 29.868069)):
        cam = ck.profiles.synthesise(SWING, base=40, follower="roller", roller=10, pivot=80, arm=60, side=side)
        found = analysed(cam, angles)
        assert abs(np.rad2deg(found.greatest_pressure_angle) - greatest) < 2e-6
        assert found.oscillates is True


def test_radii_of_curvature_of_an_offset_roller() -> None:
    """rho of the pitch curve by its polar-like formula, least 47.365; the profile's is less by the roller's."""
    cam = ck.profiles.synthesise(RISE, base=40, follower="roller", roller=10, offset=-12)
    found = analysed(cam, ck.deg(np.linspace(0, 120, 12_001)))
    u = np.linspace(0, 1, 12_001)
    s = 30 * (u - np.sin(2 * np.pi * u) / (2 * np.pi)) + np.sqrt(50**2 - 12**2)
    v = 30 * (1 - np.cos(2 * np.pi * u)) / ck.deg(120)
    a = 30 * 2 * np.pi * np.sin(2 * np.pi * u) / ck.deg(120) ** 2
    rho = (s**2 + (12 - v) ** 2) ** 1.5 / (s**2 + (12 - v) * (12 - 2 * v) - s * a)
    inner = slice(1, -1)  # the acceleration's own derivative jumps at the ends
    assert np.max(np.abs(found.pitch_radius[inner] / rho[inner] - 1)) < 1e-10
    assert np.max(np.abs(found.pitch_radius - found.radius_of_curvature - 10)[inner] / np.abs(rho[inner])) < 1e-10
    assert abs(np.min(np.abs(found.pitch_radius)) - 47.365) < 1e-3


def test_a_flat_face_has_no_pressure_angle_and_slides() -> None:
    """On a face square to its guide the normal is along it; the contact is S' from the guide."""
    cam = ck.profiles.synthesise(
        ck.laws.program(ck.laws.rise(20, np.pi), ck.laws.fall(20, np.pi)), base=40, follower="flat"
    )
    angles = np.linspace(0.2, 6.0, 50)
    found = analysed(cam, angles, speed=3.0)
    assert np.max(np.abs(found.pressure_angle)) < 1e-12
    assert found.pitch_curve is None
    motion = found.motion
    rate = motion.pairs["guide"].rate / 3.0
    # the contact lies S' to the left of the guide of a cam that turns counterclockwise ... seen along the rise
    assert np.max(np.abs(np.abs(found.contact.real) - np.abs(rate))) < 1e-10
    # the profile passes the face by omega times the height of the contact above the axis
    assert np.max(np.abs(np.abs(found.sliding) - 3.0 * found.contact.imag)) < 1e-10


def test_a_roller_spins_as_it_rolls() -> None:
    """An eccentric with a roller pinned at its end: the roller turns as gears of these radii do on the bar between."""
    mechanism_ = ck.Mechanism(
        "Eccentric",
        ck.link("frame", A=0),
        ck.link("cam", A=0, M=10),
        ck.link("follower", P=0),
        ck.slide("follower", on="frame", through="A", angle=np.pi / 2),
        ck.cam("follower", on="cam", profile=ck.profiles.disc(20, 10), radius=5),
        ck.drive("cam", speed=2.0),
    )
    motion = ck.solve(mechanism_, {"cam": np.linspace(0.0, 6.0, 25)})
    found = ck.figures.cam_analysis(motion, "follower/cam")
    bar = motion.points["P"].position - 10 * np.exp(1j * np.linspace(0.0, 6.0, 25))
    speed = motion.points["P"].velocity - 20j * np.exp(1j * np.linspace(0.0, 6.0, 25))
    turning = (np.conj(bar) * speed).imag / np.abs(bar) ** 2
    # (roller - bar) 5 = -(cam - bar) 20
    assert np.allclose(found.roller_rate, turning - (2.0 - turning) * 20 / 5, atol=1e-10)


def test_hollows_that_are_bridged() -> None:
    """A bean: a flat face bridges its hollow, a large roller too; a small one goes through it."""
    bean = ck.profiles.formula(lambda s: (30 + 8 * np.cos(2 * s)) * np.exp(1j * s), 0.0, 2 * np.pi)
    base = ck.link("frame", A=0), ck.link("cam", A=0), ck.link("follower", P=0), ck.drive("cam")
    slide = ck.slide("follower", on="frame", through="A", angle=np.pi / 2)

    def analysis(pair: Any) -> ck.results.CamAnalysis:
        return ck.figures.cam_analysis(ck.solve(ck.Mechanism("bean", *base, slide, pair)), "follower/cam")

    face = analysis(ck.face("follower", on="cam", profile=bean, angle=np.pi / 2))
    assert len(face.untouched) == 2
    # the double tangent of r = 30 + 8 cos 2s is y = const: dy/ds = 0
    s = np.linspace(0.5, np.pi / 2 - 0.1, 2_000_001)
    y = (30 + 8 * np.cos(2 * s)) * np.sin(s)
    touch = s[np.argmax(y)]
    low, high = face.untouched[0]
    assert abs(low - touch) < 1e-3
    assert abs(high - (np.pi - touch)) < 1e-3
    assert any("bridges a part of the profile" in w for w in face.warnings)
    # radius of curvature in the hollow at s = pi / 2: r^2 / (r - r'') with r = 22, r'' = 32
    hollow = 22**2 / (22 - 32)
    small, large = (analysis(ck.cam("follower", on="cam", profile=bean, radius=r)) for r in (40.0, 60.0))
    assert -hollow > 40.0
    assert not small.undercut
    assert not small.untouched
    assert len(large.undercut) == 2
    assert any("hollow that the roller of radius 60 cannot enter" in w for w in large.warnings)
    for found in (face, small, large):
        assert ck.verify(found.motion).passed
    at = np.argmin(np.abs(small.parameter - np.pi / 2))
    assert abs(small.radius_of_curvature[at] - hollow) < 0.2


def test_the_end_of_an_open_profile() -> None:
    x = np.linspace(-40.0, 40.0, 81)
    parts = (
        ck.link("frame", A=0, X=10),
        ck.link("plate", O=0),
        ck.link("pin", P=0),
        ck.slide("plate", on="frame", through="A"),
        ck.slide("pin", on="frame", through="X", angle=np.pi / 2),
        ck.cam("pin", on="plate", profile=ck.profiles.profile(x + 1j * x**2 / 40, closed=False)),
    )
    for reach, near in ((30.0, False), (49.5, True)):
        drive = ck.drive("plate", values=np.linspace(-20.0, reach, 50))
        found = ck.figures.cam_analysis(ck.solve(ck.Mechanism("slot", *parts, drive)), "pin/plate")
        assert any("end of the open profile" in w for w in found.warnings) is near


def test_what_cannot_be_analysed() -> None:
    cam = ck.profiles.synthesise(RISE, base=40)
    motion = ck.solve(mechanism(cam))
    with pytest.raises(ck.errors.UnknownName, match="did you mean 'follower/cam'"):
        ck.figures.cam_analysis(motion, "folower/cam")
    with pytest.raises(ck.errors.InvalidInput, match="a prismatic pair has no profile"):
        ck.figures.cam_analysis(motion, "guide")
    with pytest.raises(ck.errors.InvalidInput, match="no velocities"):
        ck.figures.cam_analysis(ck.solve(mechanism(cam), order=0), "follower/cam")


def test_the_report_has_a_section_on_cams() -> None:
    cam = ck.profiles.synthesise(RISE, base=40, follower="roller", roller=10, offset=12)
    report = ck.report(ck.solve(mechanism(cam), {"cam": ck.deg(np.arange(0, 361, 1))}))
    section = report.section("cams")
    assert section is not None
    table = next(block for block in section.blocks if hasattr(block, "rows"))
    rows = {row[0]: row[2:] for row in table.rows}
    _, _, high, high_at = rows["pressure angle"]
    # tan = (S' + 12) / (S + y0), greatest between the whole degrees
    u = np.linspace(0.3, 0.5, 200001)
    s = 30 * (u - np.sin(2 * np.pi * u) / (2 * np.pi)) + np.sqrt(50**2 - 12**2)
    angle = np.rad2deg(np.arctan((30 * (1 - np.cos(2 * np.pi * u)) / ck.deg(120) + 12) / s))
    assert high == pytest.approx(np.max(angle), abs=1e-9)
    assert high_at == pytest.approx(120 * u[np.argmax(angle)], abs=1e-3)
    assert rows["radius of curvature of the profile"][0] == pytest.approx(37.4, abs=0.1)
    for kind in ("text", "markdown", "json"):
        assert "customary 30" in getattr(report, kind)()
    assert ck.report(ck.solve(ck.load("catalog/six-bar.toml"))).section("cams") is None


def test_the_page_on_cams_runs_and_says_what_is_found() -> None:
    page = (Path(__file__).parents[2] / "docs" / "cams.md").read_text("utf-8")
    scope: dict[str, Any] = {}
    for code in re.findall(r"```python\n(.*?)```", page, re.DOTALL):
        exec(code, scope)
    found = np.rad2deg(scope["found"].pressure_angle)
    assert f"# {np.max(found):.1f}: the rise; the fall has {-np.min(found):.1f}" in page
    assert len(scope["found"].warnings) == 1
