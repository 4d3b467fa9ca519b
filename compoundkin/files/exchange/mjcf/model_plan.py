"""The plan of a MuJoCo model: bodies with masses, joints, constraints, and what the model cannot hold."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

from compoundkin.base.arrays import first_entry
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.poses import Pose
from compoundkin.files.exchange.mjcf.joint_tree import (
    RACK,
    CarriedLink,
    ElementaryJoint,
    JointChain,
    JointTree,
    chain_of,
    geared_tie,
    still_tie,
    straight_tie,
    tree_of,
)
from compoundkin.files.exchange.posed_mechanism import PosedMechanism
from compoundkin.model.definition import pair_by_name
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads.mass import Mass
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.contract import constraint_scales
from compoundkin.model.units import FORCES, LENGTHS, MASSES

# Bodies that stand on each other deeper are refused: they are written and read one in another.
_DEEPEST = 200


# A pair is closed but for this part of the size, or this sine: what rounding of drawn points leaves.
_CLOSED = 1e-9


# MuJoCo's least mass and inertia (mjMINVAL).
_LEAST = 1e-15


# Mechanisms smaller than this (metres) are not held together: at 1.2e-6 m MuJoCo lets go of a four-bar's closing pin,
# whatever its masses; a tenth of what is left is for links that are short beside others.
_SMALLEST = 1e-5


@dataclass(frozen=True)
class JointCoordinate:
    """The joint along which a pair moves.

    `sign` is 1 where its coordinate grows with that of the pair, else -1; `drawn` is that of the pair as drawn.
    """

    joint: str
    sign: int
    drawn: float


@dataclass(frozen=True)
class ModelPlan:
    """A mechanism as a tree of links with joints.

    Loops at pins are closed by connecting them. At another pair that closes one, half of its second link is a body of
    its own on the first, and both halves are welded: no mass is added. `halves` are such bodies, by their names, with
    the links that they belong to; `ties` are numbers by joints, whose sum with the joints' coordinates stays zero.
    """

    shown: PosedMechanism
    tree: JointTree
    units: ModelUnits
    masses: Mapping[str, BodyMass]
    connected: tuple[JointChain, ...]
    halves: Mapping[str, tuple[CarriedLink, str]]
    ties: Mapping[str, Mapping[str, float]]
    notes: tuple[str, ...]

    @cached_property
    def bodies(self) -> Mapping[str, tuple[CarriedLink, str]]:
        """All bodies by name: how they are carried, and of which links they are."""
        return {**{name: (own, name) for name, own in self.tree.carried.items()}, **self.halves}

    @cached_property
    def joints(self) -> Mapping[str, ElementaryJoint]:
        """All joints by name."""
        return {joint.name: joint for branch, _ in self.bodies.values() for joint in branch.joints}

    def unit_of(self, joint: str) -> float:
        """Return how much a unit of a joint's coordinate is in the model.

        Slides are scaled, hinges are not.
        """
        return 1.0 if self.joints[joint].is_hinge else self.units.length

    def coordinate(self, name: str) -> JointCoordinate | None:
        """Return the joint of a pair or a driver.

        None of a pin that closes a loop.
        """
        found = pair_by_name(self.shown.mechanism, name)
        if found is None:
            return None
        meant, side = found
        for own, _ in self.bodies.values():
            pair = own.chain.pair
            if pair.letters == meant.letters and {*pair.members} == {*meant.members} and pair.title == meant.title:
                turned = side if pair.members == meant.members else -side
                ends = self.shown.ends.get(pair.name, pair.ends(self.shown.mechanism.geometry))
                drawn = pair.coordinate(ends, tuple(self.shown.poses[link] for link in pair.members)).c[0]
                return JointCoordinate(pair.name, turned * own.sign, turned * float(first_entry(drawn)))
        return None

    def pose(self, link: str) -> Pose:
        """Return where a link is drawn."""
        return self.shown.poses[link].trimmed(0)

    @property
    def size(self) -> float:
        """The mechanism's size in the model's unit."""
        return float(self.shown.mechanism.geometry.size * self.units.length)

    def layer(self, link: str) -> int:
        """Return how many links lie below a link."""
        return 0 if link == FRAME else 1 + list(self.tree.carried).index(link)

    def part(self, link: str) -> BodyMass:
        """Return the mass of each of a link's bodies."""
        count = sum(1 for _, own in self.bodies.values() if own == link)
        return self.masses[link].shared(count)


def plan_of(shown: PosedMechanism) -> ModelPlan:
    """Return what is to be written of a mechanism. Raises InvalidInput listing all that no model can say."""
    chains, problems = [], [*_prescribed(shown)]
    for pair in shown.structure.pairs:
        if pair.is_geared:
            continue  # it joins no links, but ties angles of some that are joined
        chain = chain_of(shown, pair)
        if chain is not None:
            chains.append(chain)
        else:
            what = f"a {pair.title} is neither a hinge nor a slide, nor made of such"
            problems.append(Problem(pair.name, what, "leave it out, or write equivalent() of the mechanism"))
    if problems:
        raise InvalidInput(problems, heading=f"{shown.mechanism.title!r} cannot be said in MJCF")
    driven = {step.pair.name for step in shown.structure.driven.values()}
    tree = tree_of(chains, driven)
    _hold_bounds(shown, tree)
    return _plan(shown, tree, driven)


def _prescribed(shown: PosedMechanism) -> Iterator[Problem]:
    for lead in shown.mechanism.prescribed_motions.values():
        yield Problem(lead.name, "it is led along a path: no actuator does that", "drive a pin or a slide")


def _hold_bounds(shown: PosedMechanism, tree: JointTree) -> None:
    """Raise InvalidInput where links float, or stand too deep on each other."""
    floating = [name for name in shown.mechanism.links if name != FRAME and name not in tree.carried]
    problems = [Problem(name, "nothing joins it to the frame", "pin it, or lead it by a slide") for name in floating]
    if not floating and tree.depth > _DEEPEST:
        what = f"{tree.depth} links stand on each other, one body in another"
        problems.append(Problem("links", what, f"at most {_DEEPEST} can be written"))
    if problems:
        raise InvalidInput(problems, heading=f"{shown.mechanism.title!r} cannot be said in MJCF")


def _open(shown: PosedMechanism) -> Iterator[Problem]:
    """Find pairs that are open in a drawing that could not be solved, so that no joint could be zero there."""
    size = shown.mechanism.geometry.size
    for pair in shown.structure.pairs if shown.motion is None else ():
        ends = shown.ends.get(pair.name, pair.ends(shown.mechanism.geometry))
        poses = tuple(shown.poses[name].trimmed(0) for name in pair.members)
        gaps = [abs(float(first_entry(held.c[0]))) for held in pair.closure(ends, poses)]
        if any(gap > _CLOSED * scale for gap, scale in zip(gaps, constraint_scales(pair, size), strict=True)):
            what = f"it is open in the drawing, by {max(gaps):.3g}, and nothing drives the mechanism to close it"
            yield Problem(pair.name, what, "name a driver, or draw it exactly")


def _small(shown: PosedMechanism, units: ModelUnits, masses: Mapping[str, BodyMass]) -> Iterator[Problem]:
    """Find lengths and masses too small for MuJoCo."""
    size = shown.mechanism.geometry.size * units.length
    if size < _SMALLEST:
        what = f"a mechanism of {size:.3g} m is too small for MuJoCo, whose loops come apart"
        yield Problem("lengths", what, f"it is to have {_SMALLEST:g} m or more: take larger units")
    for name, own in masses.items():
        if min(own.mass, own.inertia) <= _LEAST:
            what = f"a mass of {own.mass:.3g} kg with an inertia of {own.inertia:.3g} kg m^2 is too small for MuJoCo"
            yield Problem(name, what, f"both are to be above {_LEAST:g}: take larger units")


def _plan(shown: PosedMechanism, tree: JointTree, driven: set[str]) -> ModelPlan:
    units = units_of(shown.mechanism)
    masses, told = masses_of(shown, units)
    problems = [*_open(shown), *_small(shown, units, masses)]
    if problems:
        raise InvalidInput(problems, heading=f"{shown.mechanism.title!r} cannot be said in MJCF")
    carrying = (branch.chain for branch in tree.carried.values())
    ties = {chain.pair.name: chain.tie for chain in carrying if chain.tie}
    ties.update({pair.name: geared_tie(tree, pair, shown.ends[pair.name]) for pair in shown.pairs if pair.is_geared})
    for free in shown.structure.passive:
        ties[f"{free.link} on {free.on}"] = still_tie(tree, free.link, free.on)
    connected, halves = [], {}
    for chain in tree.closing:
        straight = straight_tie(tree, chain) if chain.pair.table == RACK else None
        if straight is not None:
            ties[chain.pair.name] = straight
        elif chain.pair.table or chain.pair.name in driven:
            first, second = chain.members
            of, on, sign = (second, first, 1) if second != FRAME else (first, second, -1)
            halves[f"{of} at {chain.pair.name}"] = (CarriedLink(of, on, chain, sign), of)
            ties.update({chain.pair.name: chain.tie} if chain.tie else {})
        else:
            connected.append(chain)
    return ModelPlan(shown, tree, units, masses, tuple(connected), halves, ties, told)


# What a link weighs where nothing has a mass; a round number, so that it is seen to be made up.
_MADE_UP = 1.0


# What links without mass weigh beside others, as a part of all: MuJoCo moves nothing without mass, and steps badly
# where one link is lighter than this.
_SLIGHT = 1e-3


# The inertia of links that have none, by their mass and the mechanism's size squared: where the mass is made up, it is
# what makes them turn slowly enough for its steps; where it is given, it is next to nothing.
_MADE_UP_TURN, _OF_POINT = 1e-2, 1e-6


@dataclass(frozen=True)
class ModelUnits:
    """How many metres, kilograms and newtons a mechanism's units are, and words for it."""

    length: float
    mass: float
    force: float
    told: str

    @property
    def inertia(self) -> float:
        """The factor of inertias."""
        return self.mass * self.length**2


def units_of(mechanism: Mechanism) -> ModelUnits:
    """Return the units of a mechanism's model.

    MuJoCo has none, but its defaults suit metres and kilograms; lengths of an unknown unit stay as they are.

    >>> from compoundkin.files import load
    >>> units_of(load("six-bar")).told
    'lengths are in m (1 mm is 0.001 m), masses in kg, forces in N, torques in N m'
    """
    length = LENGTHS.get(mechanism.unit)
    units = mechanism.units
    mass, force = (1.0, 1.0) if units is None else (MASSES[units.mass], FORCES[units.force])
    forces = "masses in kg, forces in N, torques in N m"
    if length is None:
        unit = f"in {mechanism.unit}, which is unknown, and" if mechanism.unit else "without a unit and"
        return ModelUnits(1.0, mass, force, f"lengths are {unit} kept as they are; taken as m, {forces}")
    kept = "" if length == 1.0 else f" (1 {mechanism.unit} is {length:.12g} m)"
    return ModelUnits(length, mass, force, f"lengths are in m{kept}, {forces}")


@dataclass(frozen=True)
class BodyMass:
    """A body's mass, mass centre and inertia about that, in kilograms and metres.

    The centre is in the link's frame.
    """

    mass: float
    centre: complex
    inertia: float

    def shared(self, parts: int) -> BodyMass:
        """Return one of several equal parts at one place."""
        return replace(self, mass=self.mass / parts, inertia=self.inertia / parts)


def masses_of(shown: PosedMechanism, units: ModelUnits) -> tuple[Mapping[str, BodyMass], tuple[str, ...]]:
    """Return the masses of all moving links, and in sentences what is made up."""
    given = shown.mechanism.masses
    moving = [name for name in shown.mechanism.links if name != FRAME]
    without = [name for name in moving if name not in given]
    whole = sum(float(first_entry(one.mass)) for one in given.values()) * units.mass
    stand_in = (whole * _SLIGHT if given else _MADE_UP) / units.mass
    masses = {name: _mass(shown, given.get(name) or Mass(name, stand_in), units) for name in moving}
    points = [name for name, one in given.items() if not first_entry(one.inertia) and name in masses]
    return masses, (*_stated(without, bool(given), stand_in * units.mass), *_mass_points(points))


def _mass(shown: PosedMechanism, given: Mass, units: ModelUnits) -> BodyMass:
    points = shown.points[given.link]
    own = given.completed(points or {"": 0j})
    mass = float(first_entry(own.mass))
    centre = points[own.at] if isinstance(own.at, str) else complex(first_entry(own.at))
    inertia, scale = float(first_entry(own.inertia)), mass * shown.mechanism.geometry.size**2
    is_beside = bool(shown.mechanism.masses) and not given.is_complete
    if is_beside or not inertia:
        inertia = max(inertia, (_OF_POINT if given.is_complete else _MADE_UP_TURN) * scale)
    return BodyMass(mass * units.mass, centre * units.length, inertia * units.inertia)


def _stated(without: list[str], some: bool, mass: float) -> Iterator[str]:
    if without and not some:
        yield f"no masses are given: every link is a uniform bar or plate of {mass:g} kg"
    elif without:
        names = ", ".join(without)
        yield f"no masses are given for {names}: {mass:.3g} kg each, a thousandth of all others, which shows in forces"


def _mass_points(names: list[str]) -> Iterator[str]:
    if names:
        yield f"without inertia: {', '.join(names)}, given a millionth of mass times the mechanism's size squared"
