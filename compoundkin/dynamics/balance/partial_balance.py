"""Partial force balance: counterweights that leave the least shaking force, or take a fraction of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from compoundkin.base.arrays import Number, first_entry
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dynamics.balance.pin_ways import PinWays
from compoundkin.dynamics.drives.course_quadrature import nodes, smooth_pieces
from compoundkin.dynamics.work.mass_motion import mass_motions, place_of
from compoundkin.kinematics.extremes import between
from compoundkin.model.geometry import FRAME


class ShakingSamples:
    """The accelerations of masses and of links along a motion."""

    def __init__(self, ways: PinWays) -> None:
        designs, places, self.weights = nodes(smooth_pieces(ways.motion))
        self.ways, self.motion = ways, between(ways.motion, designs, places, 2)
        total = -sum((mass.force for mass in mass_motions(self.motion)), 0j)
        self.force = np.ravel(np.broadcast_to(total, self.motion.failed.shape))

    def moments(self, links: Sequence[str], added: Mapping[str, float]) -> tuple[Number, float]:
        """Return the moments about the links' pivots with the least squared shaking force.

        Return also its root mean square over that without counterweights.
        """
        poses = {name: self.motion.poses[name] for name in links}
        turned = [np.broadcast_to(np.ravel(poses[name].derivative(1.0, 2) - poses[name].derivative(0.0, 2)),
                                  self.weights.shape) for name in links]  # fmt: skip
        force = self.force
        for name in links:
            force = force - added[name] * np.ravel(poses[name].derivative(self.ways.reached[name].pivot, 2))
        root = np.sqrt(self.weights)
        columns = np.array(turned).reshape(len(links), len(self.weights)).T * root[:, None]
        found = np.linalg.lstsq(columns, force * root, rcond=None)[0] if len(links) else np.empty(0, dtype=complex)
        whole = np.linalg.norm(self.force * root)
        return found, float(np.linalg.norm(columns @ found - force * root) / whole) if whole else 0.0


def fraction_moment(ways: PinWays, fraction: float) -> tuple[str, complex]:
    """Return the crank of a slider-crank, with its classical counterweight's moment.

    All that turns is balanced, and a fraction of what goes to and fro; the rod is two masses at its pins with its mass
    centre. Raises InvalidInput for what is no slider-crank.

    Source: e.g. R. L. Norton, Design of Machinery, 5th ed., McGraw-Hill 2012, section 13.7.
    """
    crank, rod, piston = _slider_crank(ways)
    mechanism, own = ways.motion.mechanism, dict.fromkeys((crank, rod, piston), (0.0, 0j))
    for name, one in mechanism.masses.items():
        own[name] = float(first_entry(one.mass)), complex(np.ravel(place_of(ways.motion, one))[0])
    (a, on_crank), (b, _) = (_pin_between(ways, rod, other) for other in (crank, piston))
    pivot = ways.reached[crank].pivot
    mass, centre = own[rod]
    part = (centre - a) / (b - a)
    at_pin = mass * (1.0 - part) + fraction * (mass * part + own[piston][0])
    return crank, -(own[crank][0] * (own[crank][1] - pivot) + (on_crank - pivot) * at_pin)


def _slider_crank(ways: PinWays) -> tuple[str, str, str]:
    structure = ways.motion.structure
    slides = [pair for pair in structure.pairs if pair.is_simple and not pair.free_is_angle and FRAME in pair.members]
    pistons = [name for pair in slides for name in pair.members if name != FRAME]
    cranks = [name for name, one in ways.reached.items() if one.depth == 1]
    rods = [name for name in ways.motion.links if name not in (FRAME, *pistons, *cranks)]
    if not len(pistons) == len(cranks) == len(rods) == 1 or len(structure.pairs) != 4:
        remedy = "leave the fraction out: the least shaking force over the motion is then found"
        raise InvalidInput(Problem("fraction", "only a slider-crank is balanced by a fraction", remedy))
    return cranks[0], rods[0], pistons[0]


def _pin_between(ways: PinWays, link: str, other: str) -> tuple[complex, complex]:
    """Return where two links are pinned to each other, on each."""
    for pair in ways.motion.structure.pairs:
        if {link, other} == set(pair.members):
            ends = ways.motion.inputs.ends[pair.name]
            places = {name: complex(first_entry(end.point)) for name, end in zip(pair.members, ends, strict=True)}
            return places[link], places[other]
    raise InvalidInput(Problem("fraction", f"{link} and {other} are not joined", "leave the fraction out"))
