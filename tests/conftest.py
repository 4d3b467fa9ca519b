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

_EXAMPLES = 16 if os.environ.get("COMPOUNDKIN_TESTS") == "all" else 10
settings.register_profile("compoundkin", derandomize=True, deadline=None, max_examples=_EXAMPLES, database=None)
settings.load_profile("compoundkin")

# Files that take longest, in seconds on one core: each worker begins with some of them, so that none is left over
# for the end, and what is made once for a whole file is made once. A file that is not listed takes a few seconds.
SLOW = {
    "view/page/test_viewer.py": 40,
    "test_site.py": 35,
    "dimensional/test_path_generation.py": 26,
    "view/page/test_browser.py": 24,
    "dynamics/test_body_chart.py": 20,
    "dynamics/test_simulation.py": 20,
    "test_docs_examples.py": 19,
    "test_style.py": 18,
    "view/page/test_studio.py": 18,
    "stress/test_stress.py": 17,
    "test_wrong_objects.py": 17,
    "view/report/test_catalog.py": 13,
    "configurations/test_random.py": 12,
    "kinematics/test_home.py": 12,
    "kinematics/test_scale.py": 11,
    "view/page/test_drag.py": 11,
    "dimensional/test_curves.py": 10,
    "files/test_hostile_names.py": 10,
    "model/pairs/test_minimal_kind.py": 10,
    "view/plot/test_plot_command.py": 10,
    "view/sketch/test_sketch.py": 10,
    "cli/test_process.py": 9,
    "dynamics/test_phases.py": 9,
    "studies/test_optimisation.py": 9,
    "view/animation/test_svg.py": 9,
    "analysis/test_injected_faults.py": 8,
    "cli/test_mcp.py": 8,
    "dynamics/test_friction_chart.py": 8,
    "kinematics/test_configuration_curve.py": 8,
    "programs/test_jax.py": 8,
    "view/page/test_attack.py": 8,
    "analysis/test_curvature.py": 7,
    "kinematics/extremes/test_extremes.py": 7,
    "kinematics/groups/test_contract.py": 7,
    "studies/test_tolerance.py": 7,
    "view/plot/test_plot.py": 7,
    "view/report/test_report.py": 7,
    "dimensional/test_motion_generation.py": 6,
    "kinematics/test_inner_contacts.py": 6,
    "model/pairs/test_contract.py": 6,
    "studies/test_goals.py": 6,
    "view/page/test_panel.py": 6,
    "view/sketch/test_parts.py": 6,
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
