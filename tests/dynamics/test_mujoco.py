"""Efforts and accelerations of drivers by MuJoCo's mass matrix, bias forces and Jacobians, at solved poses."""

from __future__ import annotations

import zlib
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.dynamics.simulation.coordinate_change import chart_of
from compoundkin.results import Motion
from tests.catalog import mechanism as loaded
from tests.dynamics.cases import SI
from tests.dynamics.multibody import FRAME, Multibody

# One, two and more loops; dyads, a triad; slides that turn; two and three freedoms; links held twice.
NAMES = (
    *("four-bar-norton", "slider-crank-offset", "andrews-squeezer", "class-iii-six-bar", "five-bar"),
    *("oscillating-cylinder", "3-rrr", "double-parallelogram-lift"),
)
TOLERANCE = 1e-9


def heavy(name: str) -> ck.Mechanism:
    """A mechanism of the catalog whose links all have masses, with gravity; its lengths are taken as metres."""
    rng = np.random.default_rng(zlib.crc32(name.encode()))
    plain = loaded(name)
    size = plain.geometry.size
    masses = [
        ck.mass(link, rng.uniform(0.5, 2.0), at=tuple(size * rng.uniform(-0.3, 0.3, 2)),
                inertia=size**2 * rng.uniform(0.02, 0.2))
        for link in plain.links if link != FRAME
    ]  # fmt: skip
    return plain.replace(*masses, ck.gravity(*rng.uniform(-9, 9, 2)), unit="", units=SI, time=None)


def some_poses(mechanism: ck.Mechanism) -> tuple[Motion, dict[str, tuple[float, float]]]:
    """The mechanism moved with accelerations at a few of its poses that are far from limit positions."""
    driven = ck.decompose(mechanism).driven
    first = ck.solve(mechanism)
    fast = np.max([np.abs(own.angular_velocity) for own in map(first.links.__getitem__, mechanism.links)], axis=0)
    good = np.flatnonzero(first.regular[0] & np.isfinite(fast) & (fast <= 4.0 * np.nanmedian(fast) + 1e-9))
    index = good[(np.array([0.15, 0.45, 0.8]) * (len(good) - 1)).astype(int)]
    values = {name: np.broadcast_to(first.drives[name].value, first.shape)[..., index] for name in driven}
    scales = {name: 1.0 if own.pair.free_is_angle else mechanism.geometry.size for name, own in driven.items()}
    rates = {name: (1.5 * scale * (-1) ** k, 2.5 * scale) for k, (name, scale) in enumerate(scales.items())}
    speed, acceleration = ({name: own[k] for name, own in rates.items()} for k in (0, 1))
    return ck.solve(mechanism, values, speed=speed, acceleration=acceleration), rates


def differences(name: str) -> list[float]:
    """How far efforts and accelerations are apart, each by the largest that acts."""
    motion, rates = some_poses(heavy(name))
    forces, found = ck.force_analysis(motion), []
    speeds, accelerations = (np.array([own[k] for own in rates.values()]) for k in (0, 1))
    for index in range(motion.shape[-1]):
        other = Multibody(motion, index)
        other.move(speeds)
        efforts = other.efforts(accelerations)
        own = np.array([forces.drives[one].effort[index] for one in rates])
        levers = np.array([1.0 if motion.structure.driven_angles[one] else motion.size for one in rates])
        found.append(float(np.max(np.abs((own - efforts) * levers)) / np.max(np.abs(efforts * levers))))
        free = other.accelerations()
        mine = _let_go(motion, index, speeds)
        found.append(float(np.max(np.abs((mine - free) / levers)) / np.max(np.abs(free / levers))))
    return found


def _let_go(motion: Motion, index: int, speeds: np.ndarray) -> Any:
    """The accelerations of drivers that are let go at a pose with speeds."""
    values = np.array([np.broadcast_to(v[0], (1, motion.shape[-1]))[0, index] for v in motion.inputs.drives.values()])
    names = tuple(motion.inputs.drives)
    start = ck.solve(motion.mechanism, {k: [v] for k, v in zip(names, values, strict=True)}, order=1)
    chart = chart_of(start, names, {})
    return chart.rates(0.0, values, speeds).accelerations


@pytest.mark.parametrize("name", NAMES)
def test_efforts_and_accelerations(name: str) -> None:
    """Random masses: the drivers' efforts for given accelerations, and their accelerations when let go."""
    assert max(differences(name)) < TOLERANCE
