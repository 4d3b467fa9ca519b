"""The forces on a page in a real browser: arrows at the slider's pose, the section, nothing against it."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.programs.dimensions import StatedDimensions, mechanism_with
from compoundkin.view.sketch.force_arrows import drawn_moment_courses, force_courses
from compoundkin.view.sketch.kinematic_sketch import moving_sketch
from tests import catalog
from tests.view.loaded import six_bar_forces

from .conftest import PHONE

pytestmark = pytest.mark.full

PLAYER = "compoundkin.players[0]"
FORCES = f"{PLAYER}.overlays.forces"


@pytest.fixture(scope="module")
def loaded_page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("forces") / "loaded.html"
    ck.page(six_bar_forces().motion).save(path)
    return path


def test_arrows_follow_the_slider(loaded_page: Path, opened: Any) -> None:
    view, forces = opened(loaded_page), six_bar_forces()
    view.check('[data-show="forces"]')
    for k in (0, 40):
        view.value(f"k => {PLAYER}.show(k)", k)
        found = view.value(f"""() => {FORCES}.forces.map((one) => [one.told, ...{FORCES}.acts(one),
            ...one.force.map((c) => c[{PLAYER}.pose])])""")  # fmt: skip
        told = {name: (complex(x, y), complex(fx, fy)) for name, x, y, fx, fy in found}
        place, force = told["pair A on rocker by plate"]
        assert abs(place - forces.points["A"].position[k]) < 1e-6
        assert abs(force - forces.pairs["A"].force[k]) < 1e-5 * np.max(np.abs(forces.pairs["A"].force))
        assert view.value("() => document.querySelectorAll('svg .forces .ck-reaction-head').length") >= 5
    view.uncheck('[data-show="forces"]')
    assert view.value("() => document.querySelectorAll('svg .forces > *').length") == 0
    assert view.complaints == []
    assert len(view.requests) == 1


def test_arrows_and_arcs_have_names(loaded_page: Path, opened: Any) -> None:
    view, forces = opened(loaded_page), six_bar_forces()
    view.check('[data-show="forces"]')
    texts = view.value(
        "() => [...document.querySelectorAll('svg .forces text:not(.ck-halo)')].map((t) => t.textContent)"
    )
    pose = view.value(f"() => {PLAYER}.pose")
    for course in drawn_moment_courses(forces, moving_sketch(forces.motion).scene, 0):
        assert (course.shown.turning in texts) == (abs(course.moment[pose]) >= 0.01 * np.max(np.abs(course.moment)))
    assert [text for text in texts if text.startswith("F")]
    turned = view.value(f"() => {FORCES}.moments.map((one) => [one.told, [...one.moment]])")
    driven = next(np.array(values) for told, values in turned if told.startswith("driver"))
    assert np.allclose(driven, forces.drives["crank"].effort, rtol=0, atol=1e-6 * np.max(np.abs(driven)))
    # an arc turns as its moment does: counterclockwise is the sense of a positive angle
    heads = view.value(f"""() => {FORCES}.moments.filter((one) => {FORCES}.turns(one)).map(
        (one) => Math.sign(one.moment[{PLAYER}.pose]))""")  # fmt: skip
    sweeps = view.value("""() => [...document.querySelectorAll('svg .forces path[fill=none]')].map((p) =>
        Number(p.getAttribute('d').split('A')[1].split(' ')[4]))""")  # fmt: skip
    assert [-1 if sweep else 1 for sweep in sweeps] == heads
    assert view.complaints == []


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("engine-gas-pressure", {"rod.B.x": 1.1, "crank.A.x": 0.9}),
        ("planetary-train-torques", {}),
        ("andrews-squeezer-dynamics", {"K2.F.x": 1.01}),
    ],
)
def test_forces_follow_changed_dimensions(name: str, changes: dict[str, float], made: Any, opened: Any) -> None:
    """Those of a mechanism that is solved and analysed anew with the numbers of the page."""
    view, motion = opened(made(name)), catalog.motion(name)
    own = dict(view.value(f"() => {PLAYER}.path.names.map((name, k) => [name, {PLAYER}.path.own[k]])"))
    changes = changes or {next(key for key, value in own.items() if value): 1.02}
    changes = {key: own[key] * by for key, by in changes.items()}
    view.check('[data-show="forces"]')
    view.value(f"changes => {PLAYER}.design.change(changes)", changes)
    found = view.value(f"""() => [...{FORCES}.forces, ...{FORCES}.moments].map((one) => {{
        const own = {FORCES}.own(one);
        return [one.told, ...[...own.at, ...own.force, own.moment].map((part) => [...part])]; }})""")  # fmt: skip
    stated = StatedDimensions(motion.mechanism, motion.inputs.ends)
    changed = mechanism_with(stated, {stated.known[key]: value for key, value in changes.items()})
    forces = ck.force_analysis(ck.solve(changed))
    known = {
        one.shown.description: one
        for own in force_courses(forces, moving_sketch(forces.motion).scene, 0).values()
        for one in own
    }
    scale = max(np.nanmax(np.abs(one.force)) for one in known.values())
    assert found
    for told, x, y, fx, fy, moment in found:
        one = known[told]
        at, force, turning = (np.array(part, dtype=float) for part in ((x, y), (fx, fy), moment))
        good = np.isfinite(one.force) & np.isfinite(force[0])
        assert np.count_nonzero(good) > len(good) / 2
        assert np.allclose((force[0] + 1j * force[1])[good], one.force[good], rtol=0, atol=1e-8 * scale)
        assert np.allclose((at[0] + 1j * at[1])[good], one.at[good], rtol=0, atol=1e-9 * forces.motion.size)
        assert np.allclose(turning[good], one.moment[good], rtol=0, atol=1e-8 * scale * forces.motion.size)
    assert view.complaints == []


# What holds whatever the dimensions are, or follows them.
OF_STRUCTURE = {"about", "dimensions", "motion", "pairs", "mobility", "chain", "loops", "groups", "drivers"}


def test_sections_of_forces_and_motors_are_of_the_original_dimensions(made: Any) -> None:
    html = made("jaw-crusher-loaded").read_text("utf-8")
    sections = dict(re.findall(r'<section id="([a-z-]+)"([^>]*)>', html))
    assert {"forces", "motors"} <= set(sections)
    assert {key for key, rest in sections.items() if "data-depends" not in rest} == OF_STRUCTURE


def test_plots_have_no_line_from_before_a_load_acts_to_after(made: Any, opened: Any) -> None:
    """The stone presses while the jaw closes: the curve of a force has three pieces, that of a velocity one."""
    view = opened(made("jaw-crusher-loaded"))
    found = view.value("""() => Object.fromEntries([...compoundkin.players[0].outputs].map(({ name }) => {
        const quantity = compoundkin.quantity(compoundkin.players[0], name);
        const own = Array.from(quantity.parts.x ?? quantity.parts[""]);
        return [name, [quantity.switched ?? false, compoundkin.Curve.switches([own]).size]];
    }))""")  # fmt: skip
    assert found["D.force"] == [True, 2]
    assert found["T.velocity"] == [False, 0]
    assert view.complaints == []


def test_the_section_is_accessible_and_fits(loaded_page: Path, opened: Any) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    view = opened(loaded_page, PHONE, color_scheme="dark")
    view.check('[data-show="forces"]')
    assert "Assumed:" in view.value("() => document.querySelector('#forces p').textContent")
    assert view.value("() => document.documentElement.scrollWidth <= innerWidth")
    violations = axe.run(view.view).response["violations"]
    assert not violations, [(one["id"], [node["html"][:100] for node in one["nodes"]][:3]) for one in violations]
