"""Newton's iterations on the loop equations: a published table, quadratic convergence, and what does not converge."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.analysis.equations.reduced_system import pose_values
from compoundkin.files import load
from tests import catalog

newton = ck.equations.newton_iterations


def test_a_published_table() -> None:
    """github.com/ryzwyq/kdom, Newton-Rhapson/four_bar: 40, 20, 40, 30, crank at 0, from 45 and 60 deg."""
    bars = (ck.link("frame", A=0, D=40), ck.link("crank", A=0, B=20), ck.link("coupler", B=0, C=40),
            ck.link("rocker", D=0, C=30))  # fmt: skip
    mechanism = ck.Mechanism("m", *bars, ck.drive("crank"))
    found = newton(mechanism, {"crank": 0.0}, {"coupler": np.pi / 4, "rocker": np.pi / 3})
    published = [
        [0.785398163397448, 1.04719755119660],
        [0.917050660984844, 1.44901115693636],
        [0.816361116776291, 1.31874060301056],
        [0.812744041756295, 1.31809842779753],
        [0.812755561489876, 1.31811607175141],
    ]
    assert np.allclose(found.estimates[:5], published, rtol=1e-13)
    assert np.allclose(np.abs(found.residuals[0]), [6.71572875253810, 2.30350913392874], rtol=1e-13)
    assert not found.failure
    assert np.degrees(found.estimates[-1]) == pytest.approx([46.5674634422102, 75.5224878140701], abs=1e-11)
    assert found.estimates[1] - found.estimates[0] == pytest.approx(found.corrections[0])


DRAWN = ("four-bar-nikravesh", "six-bar", "slider-crank-offset", "dixon-mechanism", "five-bar", "rolling-wheel",
         "oscillating-guide", "stephenson-ii", "geared-coupler", "v8-engine")  # fmt: skip


@pytest.mark.parametrize("name", DRAWN)
def test_it_converges_by_squares_to_the_pose_of_the_groups(name: str) -> None:
    mechanism = load(name)
    motion = catalog.motion(name)
    first = {drive.name: float(np.ravel(motion.drives[drive.name].value)[0]) for drive in mechanism.drives}
    solved = pose_values(motion)
    found = newton(mechanism, first)
    assert not found.failure
    for own in found.unknowns:
        value, scale = float(np.ravel(solved[own.key])[0]), motion.size if own.is_length else 1.0
        gap = found.values[own.key] - value
        assert abs(np.angle(np.exp(1j * gap)) if own.is_angle else gap) < 1e-9 * scale, own.key
    scale = np.array([motion.size if own.is_length else 1.0 for own in found.unknowns])
    moves = np.abs(found.corrections / scale).max(axis=1)
    for before, after in pairwise(moves):
        assert before > 1e-2 or after < 30.0 * before**2 + 1e-12


def test_a_pose_out_of_reach_is_said() -> None:
    bars = ck.link("frame", A=0, D=4), ck.link("crank", A=0, B=3), ck.link("rod", B=0, C=2), ck.link("arm", C=0, D=2.5)
    mechanism = ck.Mechanism("m", *bars, ck.drive("crank", values=0.5))
    found = newton(mechanism, {"crank": 3.0})
    assert "20 steps" in found.failure or "singular" in found.failure
    assert np.isfinite(found.estimates).all()


def test_a_singular_start_is_said() -> None:
    bars = ck.link("frame", A=0, D=4), ck.link("crank", A=0, B=3), ck.link("rod", B=0, C=2), ck.link("arm", D=0, C=2.5)
    mechanism = ck.Mechanism("m", *bars, ck.drive("crank"))
    found = newton(mechanism, {"crank": 0.5}, {"rod": 1.0, "arm": 1.0})
    assert found.failure == "after 0 steps the matrix is singular"


def test_what_cannot_be_iterated() -> None:
    mechanism = load("crank-rocker")
    with pytest.raises(ck.errors.UnknownName, match="coupler"):
        newton(mechanism, {"crank": 1.0}, {"copler": 1.0})
    with pytest.raises(ck.errors.UnknownName, match="crank"):
        newton(mechanism, {"crnk": 1.0})
    with pytest.raises(ck.errors.InvalidInput, match="no value"):
        newton(mechanism, {})
    with pytest.raises(ck.errors.InvalidInput, match="one finite number"):
        newton(mechanism, {"crank": [1.0, 2.0]})  # type: ignore[dict-item]
    four = (ck.link("frame", A=0, D=5.5), ck.link("crank", A=0, B=2), ck.link("rod", B=0, C=5),
            ck.link("arm", D=0, C=4))  # fmt: skip
    with pytest.raises(ck.errors.NotDetermined):
        newton(ck.Mechanism("m", *four), {})
    bars = (ck.link("frame", A=0, D=5.5), ck.link("crank", A=0, B=2), ck.link("rod", B=0, C=np.array([[5.0], [6.0]])),
            ck.link("arm", D=0, C=4))  # fmt: skip
    with pytest.raises(ck.errors.InvalidInput, match="designs"):
        newton(ck.Mechanism("m", *bars, ck.drive("crank")), {"crank": 1.0})
