"""The forces on a page in a real browser: arrows at the slider's pose, the section, nothing against it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from tests.view.loaded import six_bar_forces

from .conftest import PHONE

pytestmark = pytest.mark.full

PLAYER = "compoundkin.players[0]"


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
        found = view.value(f"""() => {PLAYER}.forces.map((one) => [one.told, ...{PLAYER}.overlays.acts(one),
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


def test_the_section_is_accessible_and_fits(loaded_page: Path, opened: Any) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    view = opened(loaded_page, PHONE, color_scheme="dark")
    view.check('[data-show="forces"]')
    assert "Assumed:" in view.value("() => document.querySelector('#forces p').textContent")
    assert view.value("() => document.documentElement.scrollWidth <= innerWidth")
    violations = axe.run(view.view).response["violations"]
    assert not violations, [(one["id"], [node["html"][:100] for node in one["nodes"]][:3]) for one in violations]
