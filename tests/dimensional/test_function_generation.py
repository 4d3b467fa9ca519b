"""Function generators, dead centres and strokes against planted linkages and published numbers."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.dimensional.function_generation import approached_function
from compoundkin.dimensional.task_words import chebyshev_spacing

# Swing and time ratio; crank, coupler, rocker with the frame 1; the family's best least transmission angle, degrees:
# found by a prototype that searched the family directly and measured swing and times by turning the crank.
DEAD_CENTRES = [
    (40, 1.25, 0.3184492419865318, 0.7859348758000511, 1.0, 42.80780986624542),
    (60, 1.1176470588235294, 0.3409974129629684, 0.9300374999486823, 0.6984737110675672, 45.008219483744405),
    (75, 1.25, 0.4663287993221312, 0.967294640739647, 0.8032666775986481, 33.48395247175405),
    (50, 1.4827586206896552, 0.4118185209962545, 0.8357874193216005, 1.1033298996490573, 31.654425358684364),
]
# Freudenstein's equation through three Chebyshev places: log10 over 1 to 10, 60 degrees to 90; x^1.5 over 1 to 4.
THREE = [
    ([49.01923788646685, 75.0, 100.98076211353316], [68.44122948079973, 116.63264205448195, 137.5695059119052],
     (2.2867989018118617, 0.6969696579589365, 2.465226141754959)),
    ([36.02885682970026, 75.0, 113.97114317029974], [94.06433582178539, 127.96517668127753, 172.34680196836837],
     (1.6999649792230385, 2.810225809318201, 2.2238001070732336)),
]  # fmt: skip


def every(answer):
    return [*(one.candidate for one in answer), *(one.candidate for one in answer.rejected)]


@pytest.mark.parametrize(("phi", "psi", "lengths"), THREE)
def test_freudenstein_through_three_pairs(phi, psi, lengths):
    answer = ck.synthesise(ck.tasks.function(np.deg2rad(np.column_stack([phi, psi])), absolute=True))
    (found,) = every(answer)
    crank, rocker = (dyad.length for dyad in found.dyads)
    assert np.allclose([crank, found.lengths[-1], rocker], lengths, atol=1e-12)


def four_bar(phi, x):
    a, b, c, phi0, psi0 = x
    arm = a * np.exp(1j * (phi + phi0)) - 1.0
    with np.errstate(invalid="ignore"):
        return np.angle(arm) + np.arccos((np.abs(arm) ** 2 + c * c - b * b) / (2 * c * np.abs(arm))) - psi0


def slider_crank(phi, x):
    a, b, e, phi0, s0 = x
    joint = a * np.exp(1j * (phi + phi0))
    with np.errstate(invalid="ignore"):
        return joint.real + np.sqrt(b * b - (e - joint.imag) ** 2) - s0


def inverted(phi, x):
    a, _, e, phi0, psi0 = x
    arm = a * np.exp(1j * (phi + phi0)) - 1.0
    with np.errstate(invalid="ignore"):
        return np.angle(arm) - np.arcsin(e / np.abs(arm)) - psi0


LAWS = {"four-bar": four_bar, "slider-crank": slider_crank, "inverted": inverted}


@pytest.mark.parametrize(("linkage", "law"), LAWS.items())
def test_planted_generators_of_five_pairs_are_found(linkage, law):
    rng = np.random.default_rng(8)
    planted = 0
    while planted < 6:
        phi = np.sort(rng.uniform(0, 2, 5))
        x = np.concatenate([rng.uniform(0.3, 2.0, 3), rng.uniform(-3, 3, 2)])
        dense = law(np.linspace(phi[0], phi[-1], 200), x)
        if not np.isfinite(dense).all() or np.max(np.abs(np.diff(dense))) > 0.3:
            continue
        planted += 1
        answer = ck.synthesise(ck.tasks.function(np.column_stack([phi, law(phi, x)]), linkage=linkage))
        assert "at most" in answer.complete
        numbers = {"four-bar": [x[0], x[2], x[1]], "slider-crank": [x[0], x[1]], "inverted": [x[0]]}[linkage]
        assert min(np.max(np.abs(np.array(one.lengths) - numbers)) for one in every(answer)) < 1e-7
        for one in answer:
            motion = ck.solve(one.mechanism, {"input": one.values}, order=0)
            output = motion.pairs["output slide"].value if linkage == "slider-crank" else motion.links["output"].angle
            apart = np.diff(output) - np.diff(law(phi, x))
            assert np.max(np.abs(apart if linkage == "slider-crank" else np.sin(apart / 2))) < 1e-8


def test_the_minimax_error_is_less_and_even():
    log = {"between": (1, 10), "inputs": ck.deg([0, 60]), "outputs": ck.deg([0, 60])}
    task = ck.tasks.function(np.log10, **log, count=7)
    assert np.allclose(task.inputs, ck.deg(60) * (chebyshev_spacing(1, 10, 7) - 1) / 9)
    answer = ck.synthesise(task)
    best = answer[0]
    assert best.candidate.title.endswith("minimax")
    squares = next(one for one in answer if one.candidate.title.endswith("least squares"))
    exact = ck.synthesise(ck.tasks.function(np.log10, **log, count=5))
    assert best.error < squares.error < exact[0].error
    # solved again over the whole range, the error is as said, and touches its bound so often as there are freedoms
    phi = np.linspace(*log["inputs"], 181) + best.values[0] - 0.0
    motion = ck.solve(best.mechanism, {"input": phi}, order=0)
    wanted = ck.deg(60) * np.log10(1 + 9 * np.linspace(0, 1, 181))
    off = np.unwrap(motion.links["output"].angle) - wanted
    off -= (off.max() + off.min()) / 2
    assert np.isclose(np.max(np.abs(off)), best.error, rtol=1e-3)
    signs = np.sign(off[np.abs(off) > 0.98 * best.error])
    assert np.sum(np.diff(signs) != 0) >= 5


@pytest.mark.parametrize(("swing", "ratio", "crank", "coupler", "rocker", "least"), DEAD_CENTRES)
def test_crank_rockers_by_their_dead_centres(swing, ratio, crank, coupler, rocker, least):
    answer = ck.synthesise(ck.tasks.swing(np.deg2rad(swing), time_ratio=ratio))
    best = answer[0]
    assert not answer.rejected
    found = best.candidate
    lengths = found.dyads[0].length, found.lengths[-1], found.dyads[1].length
    assert np.allclose(lengths, [crank, coupler, rocker], atol=1e-6)
    assert np.isclose(np.rad2deg(best.transmission), least, atol=1e-9)
    # a second way: swing and time ratio as the package measures them along the motion, of every member
    for one in answer.solutions[::4]:
        assert one.turns
        angle = ck.quantity(one.motion, "output.angle.stroke").values[0]
        assert np.isclose(np.rad2deg(angle), swing, atol=1e-8)
        assert np.isclose(ck.quantity(one.motion, "output.angle.time_ratio").values[0], ratio, atol=1e-8)
        assert one.transmission <= best.transmission + 1e-12


@pytest.mark.parametrize(
    ("linkage", "options", "output"),
    [("slider-crank", {"offset": 40.0}, "output slide.value"), ("slider-crank", {}, "output slide.value"),
     ("crank-shaper", {}, "guide.value")],
)  # fmt: skip
def test_strokes_and_time_ratios(linkage, options, output):
    answer = ck.synthesise(ck.tasks.stroke(100, time_ratio=1.25, linkage=linkage, **options))
    assert len(answer)
    assert not answer.rejected
    for one in answer.solutions[::3]:
        assert np.isclose(ck.quantity(one.motion, f"{output}.stroke").values[0], 100, atol=1e-9)
        assert np.isclose(ck.quantity(one.motion, f"{output}.time_ratio").values[0], 1.25, atol=1e-8)
    if options:
        assert np.allclose(answer[0].candidate.lengths, [46.33946523842361, 117.65442464792991])


def test_wrong_functions_swings_and_strokes():
    with pytest.raises(ck.errors.InvalidInput, match="needs this range"):
        ck.tasks.function(np.log10, between=(1, 10))
    with pytest.raises(ck.errors.InvalidInput, match="ranges belong to a Python function"):
        ck.tasks.function([(0, 0), (1, 1), (2, 1)], between=(0, 1))
    with pytest.raises(ck.errors.InvalidInput, match="input 0 and input 2 are equal"):
        ck.tasks.function([(0, 0), (1, 1), (0, 2)])
    with pytest.raises(ck.errors.InvalidInput, match="no crank-rocker swings"):
        ck.synthesise(ck.tasks.swing(ck.deg(20), time_ratio=5))
    with pytest.raises(ck.errors.InvalidInput, match="do not go together"):
        ck.synthesise(ck.tasks.stroke(100, offset=20))
    with pytest.raises(ck.errors.InvalidInput, match="give less than"):
        ck.synthesise(ck.tasks.stroke(100, time_ratio=1.25, offset=400))
    with pytest.raises(ck.errors.InvalidInput, match="leave absolute out"):
        ck.synthesise(ck.tasks.function([(0, 0), (1, 1), (2, 1.5), (2.5, 2)], absolute=True))


@pytest.mark.parametrize("scale", [1.0, 1e-6, 1e6])
@pytest.mark.parametrize("offset", [0.0, 5.0])
def test_absolute_slider_cranks_of_any_unit_in_line_too(offset, scale):
    phi = np.array([0.3, 0.9, 1.6])
    travel = 20 * np.cos(phi) + np.sqrt(60**2 - (offset - 20 * np.sin(phi)) ** 2)
    task = ck.tasks.function(np.column_stack([phi, scale * travel]), linkage="slider-crank", absolute=True)
    (one,) = ck.synthesise(task)
    assert np.allclose(one.candidate.lengths, [20 * scale, 60 * scale], rtol=1e-9)


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_approached_displacements_do_not_depend_on_the_unit(scale):
    """Differences of SciPy's are over an absolute step: lengths are in parts of the slide's travel."""
    phi = np.linspace(0.2, 1.8, 8)
    travel = 20 * np.cos(phi) + np.sqrt(60**2 - (5 - 20 * np.sin(phi)) ** 2) + 0.1 * np.cos(7 * phi)
    one, other = (approached_function(ck.tasks.function(np.column_stack([phi, s * travel]), linkage="slider-crank",
                                                        absolute=True)).linkages for s in (1, scale))  # fmt: skip
    errors = [a.error for a in one]
    assert 0.0 < errors[1] < errors[0] < 0.3
    assert np.allclose(errors, [b.error / scale for b in other], rtol=1e-5)
    assert np.allclose([a.span for a in one], [b.span / scale for b in other], rtol=1e-3)
