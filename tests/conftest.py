"""Settings of the whole test run: the same examples every time, slow files first, and `tests.support` importable."""

from __future__ import annotations

import gc
import os
import sys
from pathlib import Path

import pytest
from hypothesis import settings

TESTS = Path(__file__).parent
# Several workers share the machine and matrices are small: one thread each, said before NumPy is imported.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Many tests start processes, and each would compile the package anew where nothing compiled is kept.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False
# Compiled programs are shared by the workers, and kept from run to run beside what pytest keeps.
os.environ.setdefault("COMPOUNDKIN_CACHE", str(TESTS.parent / ".pytest_cache" / "compiled"))
sys.path.insert(0, str(TESTS.parent))

# Nine thousand tests keep many objects: going through all of them so often takes a twentieth of the time.
gc.set_threshold(100_000, 20, 50)

_EXAMPLES = 16 if os.environ.get("COMPOUNDKIN_TESTS") == "all" else 8
settings.register_profile("compoundkin", derandomize=True, deadline=None, max_examples=_EXAMPLES, database=None)
settings.load_profile("compoundkin")

# Files that take longest, in seconds on one core: each worker begins with some of them, so that none is left over
# for the end, and what is made once for a whole file is made once. A file that is not listed takes a few seconds.
SLOW = {
    "test_site.py": 65,
    "test_style.py": 38,
    "test_docs_examples.py": 30,
    "view/page/test_studio.py": 28,
    "dimensional/test_curves.py": 27,
    "dynamics/test_simulation.py": 27,
    "view/page/test_browser.py": 26,
    "view/page/test_viewer.py": 25,
    "dimensional/test_path_generation.py": 23,
    "test_wrong_objects.py": 23,
    "stress/test_stress.py": 20,
    "kinematics/test_home.py": 14,
    "configurations/test_random.py": 12,
    "dynamics/test_friction_chart.py": 12,
    "view/page/test_drag.py": 12,
    "view/plot/test_plot_command.py": 12,
    "view/report/test_catalog.py": 12,
    "cli/test_process.py": 11,
    "view/page/test_studio_results.py": 11,
    "dynamics/test_phases.py": 10,
    "view/page/test_attack.py": 10,
    "cli/test_mcp.py": 9,
    "dimensional/test_motion_generation.py": 9,
    "programs/test_jax.py": 9,
    "view/page/test_forces_on_page.py": 9,
    "view/page/test_live_paths.py": 9,
    "dynamics/test_body_chart.py": 8,
    "kinematics/test_configuration_curve.py": 8,
    "kinematics/test_scale.py": 8,
    "model/pairs/test_minimal_kind.py": 8,
    "studies/test_optimisation.py": 8,
    "view/plot/test_study_plots.py": 8,
    "view/report/test_report.py": 8,
    "kinematics/groups/test_contract.py": 7,
    "studies/test_goals.py": 7,
    "studies/test_tolerance.py": 7,
    "studio/test_drawn_curves.py": 7,
    "test_architecture.py": 7,
    "view/page/test_figures.py": 7,
    "view/page/test_studio_pen.py": 7,
    "view/plot/test_plot.py": 7,
    "view/test_showing.py": 7,
    "analysis/test_injected_faults.py": 6,
    "files/test_hostile_names.py": 6,
    "kinematics/test_change_points.py": 6,
    "kinematics/test_inner_contacts.py": 6,
    "view/animation/test_svg.py": 6,
    "view/page/test_panel.py": 6,
}


def pytest_configure(config: pytest.Config) -> None:
    """Say what the marker means: `@pytest.mark.full` is for what takes long and needs to be known once a change."""
    config.addinivalue_line("markers", "full: only with COMPOUNDKIN_TESTS=all, as .ci/run sets it")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what only `.ci/run` runs; deal slow files out to the workers.

    xdist gives each worker an equal part of the list, and the rest can be stolen.
    """
    if os.environ.get("COMPOUNDKIN_TESTS") != "all":
        left_out = [item for item in items if item.get_closest_marker("full")]
        config.hook.pytest_deselected(items=left_out)
        items[:] = [item for item in items if not item.get_closest_marker("full")]
    workers = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
    files: dict[str, list[pytest.Item]] = {name: [] for name in SLOW}
    rest = []
    for item in items:
        name = item.path.relative_to(TESTS).as_posix() if item.path.is_relative_to(TESTS) else ""
        files.get(name, rest).append(item)
    parts: list[list[pytest.Item]] = [[] for _ in range(workers)]
    loads = [0] * workers
    for name, found in files.items():
        least = loads.index(min(loads))
        parts[least] += found
        loads[least] += SLOW[name]
    items[:] = [item for part in filled(parts, rest) for item in part]


def pytest_collection_finish() -> None:
    """Let the collector of garbage alone with what is kept to the end anyway."""
    gc.freeze()


def filled(parts: list[list[pytest.Item]], rest: list[pytest.Item]) -> list[list[pytest.Item]]:
    """Parts with as many tests each, as nearly as can be."""
    size = (sum(map(len, parts)) + len(rest)) // len(parts)
    left = iter(rest)
    full = [[*part, *(item for _, item in zip(range(size - len(part)), left, strict=False))] for part in parts]
    full[-1].extend(left)
    return full
