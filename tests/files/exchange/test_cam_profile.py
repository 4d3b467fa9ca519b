"""Tables of cam profiles: against circles that are known, and the roller of the solved motion."""

from __future__ import annotations

import csv
import io
from typing import Any

import numpy as np
import pytest
import shapely

import compoundkin as ck
from compoundkin.files import load
from compoundkin.files.exchange.known_formats import write


def table(mechanism: ck.Mechanism, **options: Any) -> tuple[dict[str, np.ndarray], tuple[str, ...]]:
    exported = write(mechanism, "cam-profile", **options)
    heads, *rows = csv.reader(io.StringIO(exported.text))
    numbers = np.array(rows, dtype=float).T
    return dict(zip(heads, numbers, strict=True)), exported.notes


def places(columns: dict[str, np.ndarray], curve: str) -> np.ndarray:
    x, y = (columns[f"{curve} {axis} [mm]"] for axis in "xy")
    return np.asarray(x + 1j * y)


def eccentric(radius: float = 20.0) -> ck.Mechanism:
    return ck.Mechanism(
        "Eccentric",
        ck.link("frame", A=0),
        ck.link("cam", A=0),
        ck.link("follower", P=0),
        ck.slide("follower", on="frame", through="A", angle=ck.deg(90)),
        ck.cam("follower", on="cam", profile=ck.profiles.disc(radius, (10, 0)), radius=5),
        ck.drive("cam"),
        unit="mm",
    )


def test_the_curves_of_a_round_disc_are_circles_within_the_tolerance() -> None:
    columns, notes = table(eccentric(), tolerance=0.01, cutter=3)
    for curve, radius in (("profile", 20.0), ("pitch", 25.0), ("cutter", 23.0)):
        own = places(columns, curve)
        assert np.abs(np.abs(own - 10) - radius).max() < 1e-9
        assert own[-1] == pytest.approx(own[0], abs=1e-12)
        # the height of a chord's segment, of all three curves
        assert (radius - np.abs((own[1:] + own[:-1]) / 2 - 10)).max() <= 0.01
    assert np.abs(columns["radius of curvature [mm]"] - 20).max() < 1e-9
    assert len(own) < 200
    error = max(25 - np.abs((own[1:] + own[:-1]) / 2 - 10) * 25 / 23)
    assert f"{error:.3g} mm" in notes[1]
    normals = columns["normal x"] + 1j * columns["normal y"]
    assert np.abs(places(columns, "profile") + 5 * normals - places(columns, "pitch")).max() < 1e-12


def test_the_pitch_curve_is_the_way_of_the_roller_seen_from_the_cam() -> None:
    cams = load("disc-cam-roller-program")
    columns, _ = table(cams, tolerance=1e-3)
    motion = ck.solve(cams)
    pair = next(one for one in cams.written_pairs if one.table == "cams")
    roller, cam = motion.points[pair.letters[0]], motion.poses[pair.on]  # type: ignore[attr-defined]
    seen = np.ravel(np.conjugate(cam.u.c[0]) * (roller.position - cam.z.c[0]))
    line = shapely.LineString([(p.real, p.imag) for p in places(columns, "pitch")])
    assert shapely.distance(line, shapely.points(seen.real, seen.imag)).max() <= 1e-3


def test_points_at_equal_steps_tell_their_error() -> None:
    columns, notes = table(eccentric(), points="90")
    steps = np.diff(columns["parameter"])
    assert len(steps) == 90
    assert np.abs(steps - steps[0]).max() < 1e-12
    assert f"{25 * (1 - np.cos(np.pi / 90)):.3g} mm" in notes[1]
    for count in (3, "many", 1e9):
        with pytest.raises(ck.errors.InvalidInput, match="points: "):
            table(eccentric(), points=count)
    with pytest.raises(ck.errors.InvalidInput, match="both given"):
        table(eccentric(), points=90, tolerance=0.1)


def test_of_several_cams_one_is_named() -> None:
    second = (ck.link("tappet", Q=0), ck.slide("tappet", on="frame", through="A", angle=ck.deg(30)))
    back = ck.cam("tappet", on="cam", profile=ck.profiles.disc(30, (0, 4)), name="back")
    double = ck.Mechanism("Double", *(item for item in eccentric().items), *second, back, unit="mm")
    with pytest.raises(ck.errors.InvalidInput, match="there are 2; name one: follower/cam, back"):
        table(double)
    with pytest.raises(ck.errors.UnknownName, match="no cam pair 'bach'; did you mean 'back'"):
        table(double, cam="bach")
    assert np.abs(np.abs(places(table(double, cam="back", points=64)[0], "profile") - 4j) - 30).max() < 1e-9
    with pytest.raises(ck.errors.InvalidInput, match="it has no cam"):
        table(load("six-bar"))


def test_a_cutter_that_would_cut_into_the_profile_is_refused() -> None:
    """Of y = x^2 / 80 the least radius of curvature is 40, in the hollow at (0, 0), above which the pin runs."""
    groove = load("groove-cam-plate")
    for side in (1, -1):
        mirrored = groove if side > 0 else None
        if mirrored is not None:
            columns, _ = table(mirrored)
            assert np.abs(columns["radius of curvature [mm]"]).min() == pytest.approx(40, rel=1e-3)
    wavy = [(30 + 6 * np.cos(5 * q)) * np.exp(1j * q) for q in np.linspace(0, 2 * np.pi, 60, endpoint=False)]
    waves = ck.Mechanism(
        "Waves",
        ck.link("frame", A=0),
        ck.link("cam", A=0),
        ck.link("follower", P=0),
        ck.slide("follower", on="frame", through="A", angle=ck.deg(90)),
        ck.cam("follower", on="cam", profile=ck.profiles.profile([(p.real, p.imag) for p in wavy])),
        ck.drive("cam"),
        unit="mm",
    )
    # the curvature of r = 30 + 6 cos 5q where cos 5q = -1: (r^2 - r r'') / r^3 = (24 - 150) / 24^2
    assert table(waves, cutter=24**2 / 126 * 0.98)[0]
    with pytest.raises(ck.errors.InvalidInput, match="into the profile; take a smaller one"):
        table(waves, cutter=24**2 / 126 * 1.05)


def test_a_flat_face_has_no_pitch_curve() -> None:
    columns, notes = table(load("flat-faced-follower"), points=16)
    assert not any(name.startswith("pitch") for name in columns)
    assert notes[-1] == "a flat face has no pitch curve"
