"""MuJoCo's XML files: a mechanism as a model with joints at zero in the pose as drawn.

Its elements are bodies and shapes, equality constraints, drivers and loads.
"""

from __future__ import annotations

from cmath import phase
from collections import Counter
from collections.abc import Iterator, Mapping
from math import radians, tan
from typing import Any, ClassVar
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import numpy as np

from compoundkin.base.arrays import TURN, Number, first_entry
from compoundkin.base.display import printable
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series
from compoundkin.files.exchange.contract import Exported, Writable
from compoundkin.files.exchange.foreign_texts import shortest
from compoundkin.files.exchange.mjcf.joint_tree import CarriedLink, ElementaryJoint, JointChain
from compoundkin.files.exchange.mjcf.model_plan import ModelPlan, plan_of
from compoundkin.files.exchange.posed_mechanism import PosedMechanism
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads.spring import COMPRESSION, TENSION
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.symbols import Wheel


def place(value: complex) -> str:
    """Return a place of the plane."""
    return f"{shortest(value.real)} {shortest(value.imag)} 0"


def site_name(plan: ModelPlan, letter: str, link: str) -> str:
    """Return the name of a link's point.

    It is the letter on the first link that has it.

    >>> from compoundkin.files.exchange.mjcf.model_plan import plan_of
    >>> from compoundkin.files.exchange.posed_mechanism import posed_mechanism
    >>> from compoundkin.files import load
    >>> plan = plan_of(posed_mechanism(load("slider-crank")))
    >>> site_name(plan, "A", "crank"), site_name(plan, "A", "rod")
    ('A', 'A on rod')
    """
    return letter if plan.shown.mechanism.carriers[letter][0] == link else f"{letter} on {link}"


def body_elements(plan: ModelPlan) -> dict[str, Element]:
    """Return the bodies of all links, each in that of its parent.

    The first is the frame's.
    """
    world = Element("worldbody")
    _add_sites(plan, world, FRAME)
    elements = {FRAME: world}
    for name, (branch, link) in plan.bodies.items():
        body = SubElement(elements[branch.parent], "body", {"name": name, **_pose(plan, branch, link)})
        mass = plan.part(link)
        SubElement(
            body,
            "inertial",
            pos=place(mass.centre),
            mass=shortest(mass.mass),
            diaginertia=" ".join([shortest(mass.inertia)] * 3),
        )
        for joint in branch.joints:
            _add_joint(plan, body, joint, link)
        if name == link:
            elements[link] = body
            _add_sites(plan, body, link)
    return elements


def _pose(plan: ModelPlan, branch: CarriedLink, link: str) -> dict[str, str]:
    local = plan.pose(branch.parent).inverse().compose(plan.pose(link))
    pos = place(complex(local.z.c[0]) * plan.units.length)
    angle = phase(complex(local.u.c[0]))
    return {"pos": pos, "euler": f"0 0 {shortest(angle)}"} if angle else {"pos": pos}


def _add_joint(plan: ModelPlan, body: Element, joint: ElementaryJoint, link: str) -> None:
    back = plan.pose(link).inverse()
    scale = 1.0 if joint.is_hinge else plan.units.length
    words = {"name": joint.name, "type": "hinge" if joint.is_hinge else "slide"}
    if joint.is_hinge:
        words |= {"pos": place(complex(back.at(joint.axis).c[0]) * plan.units.length), "axis": "0 0 1"}
    else:
        words |= {"axis": place(complex(back.u.c[0]) * joint.axis)}
    if joint.reach is not None:
        words["range"] = " ".join(shortest(end * scale) for end in joint.reach)
    SubElement(body, "joint", words)


def _add_sites(plan: ModelPlan, body: Element, link: str) -> None:
    for letter, own in plan.shown.points[link].items():
        SubElement(body, "site", name=site_name(plan, letter, link), pos=place(own * plan.units.length))


# Half the width of a bar, by the mechanism's size; links lie on each other, so much from one to the next.
_HALF_WIDTH, _LAYER = 0.012, 0.03


# Points nearer to each other than this part of the size are no bar.
_NO_BAR = 1e-6


_DISC, _RING = "0.3 0.5 0.7 0.35", "0.3 0.3 0.3 0.12"


_FRAME_COLOUR = "0.45 0.45 0.45 1"


_COLOURS = ("0.12 0.47 0.71 1", "0.89 0.47 0.12 1", "0.17 0.63 0.17 1", "0.84 0.15 0.16 1", "0.58 0.40 0.74 1",
            "0.55 0.34 0.29 1", "0.09 0.75 0.81 1", "0.74 0.74 0.13 1")  # fmt: skip


def add_shapes(plan: ModelPlan, bodies: Mapping[str, Element]) -> None:
    """Add to each link's body what is to be seen of it."""
    for k, (link, body) in enumerate(bodies.items()):
        colour = _COLOURS[(k - 1) % len(_COLOURS)] if k else _FRAME_COLOUR
        for words in _frame_shapes(plan) if link == FRAME else _link_shapes(plan, link):
            SubElement(body, "geom", {**words, "rgba": colour})
    for chain in (*(own.chain for own, _ in plan.bodies.values()), *plan.connected):
        guide = _guide(plan, chain)
        if guide is not None:
            SubElement(bodies[chain.members[0]], "geom", guide)
    for pair in plan.shown.pairs:
        for link, words in _wheels(plan, pair):
            SubElement(bodies[link], "geom", words)


def _wheels(plan: ModelPlan, pair: Pair) -> Iterator[tuple[str, dict[str, str]]]:
    """Yield a pair's wheels as thin discs that one can see through."""
    poses = tuple(plan.shown.poses[name].mapped(_along_a_motion) for name in pair.members)
    marks = pair.glyph(plan.shown.ends[pair.name], poses)
    for mark in (mark for mark in marks if isinstance(mark, Wheel)):
        radius, link = float(first_entry(mark.radius)), pair.members[mark.member]
        if not radius:
            continue
        height = plan.layer(link) * _LAYER * plan.size
        size = f"{shortest(radius * plan.units.length)} {shortest(0.3 * _HALF_WIDTH * plan.size)}"
        at = _at(complex(first_entry(mark.at)) * plan.units.length, height)
        yield link, {"type": "cylinder", "pos": at, "size": size, "rgba": _RING if mark.is_ring else _DISC}


def _along_a_motion(series: Series) -> Series:
    """Return a series at one pose as one over a motion of it."""
    return Series(tuple(np.atleast_1d(part) for part in series.c[:1]))


def _link_shapes(plan: ModelPlan, link: str) -> Iterator[dict[str, str]]:
    """Yield bars around a link's points, or a block at its only one."""
    points = [own * plan.units.length for own in plan.shown.points[link].values()]
    height = plan.layer(link) * _LAYER * plan.size
    around = list(zip(points, [*points[1:], points[0]], strict=True)) if len(points) > 2 else [tuple(points)]
    bars = [two for two in around if len(two) == 2 and abs(two[1] - two[0]) > _NO_BAR * plan.size]
    for one, other in bars:
        yield _bar(one, other, height, _HALF_WIDTH * plan.size)
    if not bars:
        at = points[0] if points else 0j
        along = next((joint.axis for joint in plan.tree.carried[link].joints if not joint.is_hinge), 1 + 0j)
        turn = along * complex(plan.pose(link).u.c[0]).conjugate()
        size = " ".join(shortest(part * _HALF_WIDTH * plan.size) for part in (3.0, 2.0, 1.0))
        yield {"type": "box", "pos": _at(at, height), "size": size, "euler": f"0 0 {shortest(float(np.angle(turn)))}"}


def _frame_shapes(plan: ModelPlan) -> Iterator[dict[str, str]]:
    for own in plan.shown.points[FRAME].values():
        radius = shortest(1.6 * _HALF_WIDTH * plan.size)
        yield {"type": "sphere", "pos": _at(own * plan.units.length, 0.0), "size": radius}


def _guide(plan: ModelPlan, chain: JointChain) -> dict[str, str] | None:
    """Return the line on which a slide's block runs, as far as the motion uses it."""
    first, second = chain.members
    slide = chain.joints[0]
    if slide.is_hinge:
        return None
    pair, motion = chain.pair, plan.shown.motion
    ends = plan.shown.ends[pair.name]
    if motion is None:
        return None
    ways = np.ravel(pair.coordinate(ends, tuple(motion.poses[name] for name in (first, second))).c[0])
    now = float(pair.coordinate(ends, tuple(plan.shown.poses[name] for name in (first, second))).c[0])
    back = complex(plan.pose(first).u.c[0]).conjugate() * slide.axis
    middle = plan.pose(first).inverse().at(plan.shown.place(second, complex(ends[1].point))).c[0]
    low, high = (complex(middle + back * (way - now)) * plan.units.length for way in (np.nanmin(ways), np.nanmax(ways)))
    if abs(high - low) <= _NO_BAR * plan.size:
        return None
    height = plan.layer(first) * _LAYER * plan.size
    return {**_bar(low, high, height, 0.4 * _HALF_WIDTH * plan.size), "rgba": _FRAME_COLOUR}


def _bar(one: complex, other: complex, height: float, radius: float) -> dict[str, str]:
    return {"type": "capsule", "fromto": f"{_at(one, height)} {_at(other, height)}", "size": shortest(radius)}


def _at(place: complex, height: float) -> str:
    return f"{shortest(place.real)} {shortest(place.imag)} {shortest(height)}"


def constraint_elements(plan: ModelPlan, tendons: Element) -> Iterator[Element]:
    """Yield all tendons, then all equality constraints.

    Tendons of loads are given; sums of joints that are held are added.
    """
    held = Element("equality")
    for chain in plan.connected:
        SubElement(held, "connect", _sites(plan, chain))
    for name, (_, link) in plan.halves.items():
        # angles count as much as lengths
        SubElement(held, "weld", name=name, body1=link, body2=name, torquescale=shortest(plan.size))
    for name, tie in plan.ties.items():
        _add_tie(plan, name, tie, held, tendons)
    yield from (element for element in (tendons, held) if len(element))


def _sites(plan: ModelPlan, chain: JointChain) -> dict[str, str]:
    letter = chain.pair.letters[0]
    one, two = (site_name(plan, letter, link) for link in chain.members)
    return {"name": chain.pair.name, "site1": one, "site2": two}


def _add_tie(plan: ModelPlan, name: str, tie: Mapping[str, float], held: Element, tendons: Element) -> None:
    """Add a joint that follows another, or the sum of several joints that stays."""
    scaled = {joint: factor / plan.unit_of(joint) for joint, factor in tie.items()}
    if not scaled:
        return
    (last, whole), *others = reversed(scaled.items())
    if len(others) > 1:
        SubElement(held, "tendon", name=name, tendon1=name)
        fixed = SubElement(tendons, "fixed", name=name)
        for joint, factor in scaled.items():
            SubElement(fixed, "joint", joint=joint, coef=shortest(factor))
        return
    words = {"name": name, "joint1": last, "polycoef": "0 0 0 0 0"}
    for joint, factor in others:
        words |= {"joint2": joint, "polycoef": f"0 {shortest(-factor / whole)} 0 0 0"}
    SubElement(held, "joint", words)


# The drawn pose in motion: what the keyframe is called.
KEYFRAME = "drawn"


# A driver that turns as far but for so much of it makes full turns.
_ROUNDING = 1e-9


def driver_elements(plan: ModelPlan, world: Element, loads: Element, lag: float) -> Iterator[Element]:
    """Yield the actuators, those of loads last, and the keyframe.

    A driver is drawn by a critically damped spring toward a place that moves with its speed; `lag` is the time
    constant of that in seconds. It stops at the ends of the range over which the mechanism is solved.
    """
    actuators, key = Element("actuator"), Element("key", name=KEYFRAME)
    speeds = dict(_speeds(plan))
    for name, (joint, _) in speeds.items():
        weight = moved_mass(plan, name, joint)
        words = {"kp": shortest(weight / lag**2), "kv": shortest(2.0 * weight / lag)}
        ends = _range(plan, name, joint)
        words |= {"actrange": " ".join(shortest(end) for end in ends)} if ends else {}
        SubElement(actuators, "intvelocity", {"name": name, "joint": joint, **words})
    actuators.extend(loads)
    rates, joints = joint_rates(plan), [joint.get("name", "") for joint in world.iter("joint")]
    key.set("qpos", " ".join(["0"] * len(joints)))
    key.set("qvel", " ".join(shortest(rates[name] * plan.unit_of(name)) for name in joints))
    if len(actuators):
        # what a load pulls is in its gear; a place that is ahead of its driver draws it with the right speed
        key.set("ctrl", " ".join([*(shortest(speed) for _, speed in speeds.values()), *["1"] * len(loads)]))
        key.set("act", " ".join(shortest(2.0 * lag * speed) for _, speed in speeds.values()))
        yield actuators
    frames = Element("keyframe")
    frames.append(key)
    yield frames


def moved_mass(plan: ModelPlan, name: str, joint: str) -> float:
    """Return the mass or inertia of all links as a driver feels it.

    It is the median over the poses. That is twice their energy by the square of its speed;
    where it is not known, that of all masses at the size.
    """
    motion, total = plan.shown.motion, sum(mass.mass for mass in plan.masses.values())
    rough = total * (plan.size**2 if plan.joints[joint].is_hinge else 1.0)
    if motion is None:
        return rough
    energy: Number = 0.0
    for link, own in plan.masses.items():
        pose, length = motion.poses[link], plan.units.length
        turning = (pose.derivative(1.0, 1) - pose.derivative(0.0, 1)) * np.conjugate(pose.u.c[0])
        energy = energy + own.mass * np.abs(pose.derivative(own.centre / length, 1) * length) ** 2
        energy = energy + own.inertia * turning.imag**2
    rate = np.ravel(motion.drives[name].rate) * plan.unit_of(joint)
    with np.errstate(all="ignore"):
        felt = np.ravel(energy) / rate**2
    known = felt[np.isfinite(felt) & (felt > 0.0)]
    found = float(np.median(known)) if known.size else rough
    # the energy is that of all drivers together
    return min(found, rough) if len(plan.shown.values) > 1 else found


def _range(plan: ModelPlan, name: str, joint: str) -> tuple[float, float] | None:
    """Return from where to where a driver's joint may go; None where it makes full turns, or is known at a pose."""
    motion = plan.shown.motion
    if motion is None or motion.inputs.poses < 2:
        return None
    values = np.broadcast_to(np.ravel(motion.drives[name].value), motion.assembled.shape).ravel()
    drawn, solved = plan.shown.values[name], np.ravel(motion.assembled)
    if solved.all() and plan.joints[joint].is_hinge and np.ptp(values) >= TURN * (1.0 - _ROUNDING):
        return None
    # of several ranges that in which it is drawn
    at = int(np.argmin(np.where(solved, np.abs(values - drawn), np.inf)))
    gaps = np.flatnonzero(~solved)
    run = values[gaps[gaps < at].max(initial=-1) + 1 : gaps[gaps > at].min(initial=values.size)]
    sign = dict(_signs(plan))[name]
    ways = sign * (np.append(run, drawn) - drawn) * plan.unit_of(joint)
    return (float(ways.min()), float(ways.max())) if np.ptp(ways) > 0.0 else None


def _signs(plan: ModelPlan) -> Iterator[tuple[str, int]]:
    """Yield the drivers with 1 or -1, as their joints move with them."""
    signs = {own.chain.pair.name: own.sign for own, _ in plan.bodies.values()}
    for name, step in plan.shown.structure.driven.items():
        yield name, signs[step.pair.name] * step.pair.driven_by(step.drive.link)


def _speeds(plan: ModelPlan) -> Iterator[tuple[str, tuple[str, float]]]:
    """Yield the drivers with their joints and the speeds of these, in the model's units."""
    for name, sign in _signs(plan):
        step = plan.shown.structure.driven[name]
        joint = step.pair.name
        speed = plan.shown.rates.get(name, float(first_entry(step.drive.speed)))
        yield name, (joint, sign * speed * plan.unit_of(joint))


def fastest(plan: ModelPlan) -> float:
    """Return the rate of the fastest driver: radians a second, or sizes a second."""
    rates = [abs(speed) / (1.0 if plan.joints[joint].is_hinge else plan.size) for _, (joint, speed) in _speeds(plan)]
    return max(rates, default=0.0)


def joint_rates(plan: ModelPlan) -> Mapping[str, float]:
    """Return the rates of all joints; zeros where some are not known.

    They are in radians or the mechanism's lengths a second.

    >>> from compoundkin.files.exchange.mjcf.model_plan import plan_of
    >>> from compoundkin.files.exchange.posed_mechanism import posed_mechanism
    >>> from compoundkin.files import load
    >>> round(joint_rates(plan_of(posed_mechanism(load("slider-crank"))))["O"], 9)
    1.6
    """
    found = {name: rate for branch, link in plan.bodies.values() for name, rate in _rates(plan, branch, link)}
    known = plan.shown.motion is not None and all(np.isfinite(rate) for rate in found.values())
    return found if known else dict.fromkeys(plan.joints, 0.0)


def _rates(plan: ModelPlan, branch: CarriedLink, link: str) -> Iterator[tuple[str, float]]:
    """Yield the rates of a body's joints: together they give its motion relative to its parent."""
    at = complex(plan.shown.poses[link].z.c[0])
    (turn, shift), (before, carried) = (_moved(plan.shown.poses[name], at) for name in (link, branch.parent))
    columns = [(1.0, 1j * (at - joint.axis)) if joint.is_hinge else (0.0, joint.axis) for joint in branch.joints]
    matrix = np.array([[w for w, _ in columns], [v.real for _, v in columns], [v.imag for _, v in columns]])
    right = np.array([turn - before, (shift - carried).real, (shift - carried).imag])
    if not np.all(np.isfinite(right)):
        yield from ((joint.name, np.nan) for joint in branch.joints)
        return
    # turns and shifts do not compare; each joint has one of them that the others have not
    rates = np.linalg.lstsq(matrix, right, rcond=None)[0]
    yield from ((joint.name, float(rate)) for joint, rate in zip(branch.joints, rates, strict=True))


def _moved(pose: Pose, at: complex) -> tuple[float, complex]:
    """Return how fast a link turns, and the velocity of its point at a place."""
    rates = [complex(part.c[1]) if part.order else 0j for part in (pose.z, pose.u)]
    turning = (rates[1] * complex(pose.u.c[0]).conjugate()).imag
    return turning, rates[0] + 1j * turning * (at - complex(pose.z.c[0]))


# The site whose axes are those of the frame.
AXES = "axes of the frame"


# A length that no spring reaches, as a part of the size.
_FAR = 1e3


class ModelLoads:
    """The loads that a model has: actuators, tendons, and what joints say. `left` names those that it has not."""

    def __init__(self, plan: ModelPlan, bodies: Mapping[str, Element]) -> None:
        self.actuators, self.tendons = Element("actuator"), Element("tendon")
        self._plan, self._bodies, self._units = plan, bodies, plan.units
        self._joints = {joint.get("name", ""): joint for joint in bodies[FRAME].iter("joint")}
        ways = {"forces": self._force, "torques": self._torque, "efforts": self._effort,
                "springs": self._spring, "dampers": self._damper}  # fmt: skip
        mechanism = plan.shown.mechanism
        loads = mechanism.loads.items()
        self.left = [name for name, load in loads if load.table not in ways or not ways[load.table](load)]
        self.left += [f"friction of {name}" for name in mechanism.frictions]
        self.left += [f"pretension of {name}" for name in mechanism.pretensions]
        if any(element.get("refsite") for element in self.actuators):
            SubElement(bodies[FRAME], "site", name=AXES, pos=place(0j))

    def _force(self, load: Any) -> bool:
        force = _constant(load.force)
        if force is None or load.while_moving is not None or load.fixed_in not in (FRAME, load.link):
            return False
        site = self._site(load.link, load.at, load.name)
        gear = f"{place(force * self._units.force)} 0 0 0"
        words = {"refsite": AXES} if load.fixed_in == FRAME else {}
        SubElement(self.actuators, "motor", {"name": load.name, "site": site, **words, "gear": gear})
        return True

    def _torque(self, load: Any) -> bool:
        torque = _constant(load.torque)
        if torque is None:
            return False
        site = self._site(load.link, 0j, load.name)
        gear = f"0 0 0 0 0 {shortest(torque.real * self._units.force * self._units.length)}"
        SubElement(self.actuators, "motor", name=load.name, site=site, gear=gear)
        return True

    def _effort(self, load: Any) -> bool:
        amount, found = _constant(load.amount), self._plan.coordinate(load.pair)
        if amount is None or found is None or load.only is not None:
            return False
        gear = shortest(found.sign * amount.real * self._effort_unit(found.joint))
        SubElement(self.actuators, "motor", name=load.name, joint=found.joint, gear=gear)
        return True

    def _spring(self, load: Any) -> bool:
        is_along = hasattr(load, "pair")
        told = (load.stiffness, load.free if is_along else load.free_length, load.preload)
        stiffness, free, preload = (_constant(value) for value in told)
        if stiffness is None or free is None or preload is None or stiffness.real <= 0.0:
            return False
        rest = (free - preload / stiffness).real
        if is_along:
            return load.only is None and self._joint_spring(load, stiffness.real, rest)
        length, far = rest * self._units.length, _FAR * self._plan.size
        ends = {TENSION: (0.0, length), COMPRESSION: (length, far)}.get(load.only, (length, length))
        pull = shortest(stiffness.real * self._units.force / self._units.length)
        return rest >= 0.0 and self._tendon(load, stiffness=pull, springlength=" ".join(shortest(end) for end in ends))

    def _joint_spring(self, load: Any, stiffness: float, rest: float) -> bool:
        found = self._plan.coordinate(load.pair)
        if found is None or self._joints[found.joint].get("stiffness"):
            return False
        unit = self._plan.unit_of(found.joint)
        self._joints[found.joint].set("stiffness", shortest(stiffness * self._effort_unit(found.joint) / unit))
        self._joints[found.joint].set("springref", shortest(found.sign * (rest - found.drawn) * unit))
        return True

    def _damper(self, load: Any) -> bool:
        rate = _constant(load.rate)
        if rate is None:
            return False
        if not hasattr(load, "pair"):
            return self._tendon(load, damping=shortest(rate.real * self._units.force / self._units.length))
        found = self._plan.coordinate(load.pair)
        if found is None or self._joints[found.joint].get("damping"):
            return False
        scale = self._effort_unit(found.joint) / self._plan.unit_of(found.joint)
        self._joints[found.joint].set("damping", shortest(rate.real * scale))
        return True

    def _tendon(self, load: Any, **words: str) -> bool:
        """Add a tendon between the two ends of a load."""
        spatial = SubElement(self.tendons, "spatial", {"name": load.name, **words})
        for link, own in ((load.link, load.point), (load.to, load.at)):
            SubElement(spatial, "site", site=self._site(link, own, f"{load.name} on {link}"))
        return True

    def _site(self, link: str, own: str | complex, name: str) -> str:
        """Return the site at a point of a link, a new one where the point has no letter."""
        if isinstance(own, str):
            return site_name(self._plan, own, link)
        SubElement(self._bodies[link], "site", name=name, pos=place(complex(own) * self._units.length))
        return name

    def _effort_unit(self, joint: str) -> float:
        """Return how much a unit of effort along a joint is in the model."""
        return self._units.force * (self._units.length if self._plan.joints[joint].is_hinge else 1.0)


def _constant(amount: Any) -> complex | None:
    """Return an amount that is one number, or None."""
    is_number = isinstance(amount, int | float | complex) or (isinstance(amount, np.ndarray) and amount.size == 1)
    return complex(np.ravel(amount)[0]) if is_number else None


# In how many steps drivers catch up.
_OF_DRIVERS = 16.0


# MuJoCo's own name of the frame.
_WORLD = "world"


class MjcfFormat(Writable):
    """MuJoCo's models. They are written, not read."""

    name: ClassVar[str] = "mjcf"
    program: ClassVar[str] = "MuJoCo"
    title: ClassVar[str] = "MuJoCo model (MJCF)"
    suffix: ClassVar[str] = ".xml"

    def write(self, shown: PosedMechanism, **options: Any) -> Exported:
        """Return the model. Raises InvalidInput listing all that hinges, slides and their sums cannot say.

        >>> from compoundkin.files.exchange.posed_mechanism import posed_mechanism
        >>> from compoundkin.files import load
        >>> found = FORMAT.write(posed_mechanism(load("slider-crank")))
        >>> found.text.count("<body "), found.text.count("<connect ")
        (3, 1)
        """
        plan = plan_of(shown)
        bodies = body_elements(plan)
        loads = ModelLoads(plan, bodies)
        notes = (*_notes(plan, loads.left), *plan.notes)
        model = _model(plan, bodies, loads, notes)
        indent(model)
        return Exported(tostring(model, "utf-8", xml_declaration=False) + b"\n", self.name, notes)


def _model(plan: ModelPlan, bodies: Mapping[str, Element], loads: ModelLoads, notes: tuple[str, ...]) -> Element:
    """Return the whole model."""
    world = bodies[FRAME]
    add_shapes(plan, bodies)
    world.append(camera(plan))
    model = Element("mujoco", model=printable(plan.shown.mechanism.title))
    model.extend(settings(plan, notes))
    model.append(world)
    model.extend(constraint_elements(plan, loads.tendons))
    model.extend(driver_elements(plan, world, loads.actuators, _OF_DRIVERS * step_of(plan)))
    _hold_names(model)
    return model


def _notes(plan: ModelPlan, left: list[str]) -> Iterator[str]:
    """Yield in sentences what the numbers mean, and what of the mechanism is left out."""
    yield plan.units.told
    laws = [drive.name for drive in plan.shown.mechanism.drives if drive.law is not None]
    if laws:
        yield f"laws of time are not in a model: {', '.join(laws)} keeps the speed of this pose"
    for free in plan.shown.structure.passive:
        yield f"{free}: it is held as it is drawn"
    if left:
        yield f"loads that no model says are left out: {', '.join(left)}"


def _hold_names(model: Element) -> None:
    """Raise InvalidInput where two elements of one sort would have one name."""
    named = Counter({("body", _WORLD): 1})
    for section in model:
        within = section.iter() if section.tag == "worldbody" else iter(section)
        sort = "" if section.tag == "worldbody" else section.tag
        named.update((sort or own.tag, own.get("name", "")) for own in within if own.get("name"))
    twice = [
        Problem(name, f"two of one name: {sort}", "call one of them otherwise")
        for (sort, name), count in named.items()
        if count > 1
    ]
    if twice:
        raise InvalidInput(twice, heading="a model of MuJoCo has every name once")


FORMAT = MjcfFormat()


# The longest step (seconds), and how many make a turn of the fastest driver, or a way of six sizes.
_LONGEST, _STEPS = 2.5e-4, 2000


# In how many steps constraints catch up. Two are the least in MuJoCo, which suit where nothing moves fast beside the
# driver; with eight all shipped mechanisms run.
_OF_CONSTRAINTS = 8.0


# How hard constraints are, between MuJoCo's own 0.9 to 0.95 and 1: they stand for pairs.
_HARD = "0.99 0.999 0.001"


# What the camera sees: an angle (degrees), and so many times what is drawn.
_ANGLE, _ROOM = 30.0, 1.2


# The radius of points, by the mechanism's size.
_POINT = 0.006


def step_of(plan: ModelPlan) -> float:
    """Return the step of a model in seconds."""
    rate = fastest(plan)
    return min(_LONGEST, TURN / rate / _STEPS) if rate else _LONGEST


def settings(plan: ModelPlan, notes: tuple[str, ...]) -> Iterator[Element]:
    """Yield what stands before the bodies. The notes are in it, as texts."""
    yield Element("compiler", angle="radian", autolimits="true")
    fall, step = complex(first_entry(plan.shown.mechanism.gravity)), step_of(plan)
    option = Element("option", timestep=shortest(step), integrator="implicitfast", gravity=place(fall))
    SubElement(option, "flag", contact="disable")
    yield option
    middle, width = _view(plan)
    yield Element("statistic", center=place(middle), extent=shortest(width))
    defaults = Element("default")
    SubElement(defaults, "equality", solref=f"{shortest(_OF_CONSTRAINTS * step)} 1", solimp=_HARD)
    SubElement(defaults, "geom", contype="0", conaffinity="0")
    SubElement(defaults, "site", size=shortest(_POINT * plan.size))
    yield defaults
    yield from _appearance()
    custom = Element("custom")
    for k, note in enumerate(notes):
        SubElement(custom, "text", name=f"note {k + 1}", data=printable(note))
    yield custom


def _appearance() -> Iterator[Element]:
    """Yield light from the eye, and a bright background."""
    visual, asset = Element("visual"), Element("asset")
    SubElement(visual, "headlight", ambient="0.5 0.5 0.5", diffuse="0.5 0.5 0.5", specular="0.1 0.1 0.1")
    SubElement(asset, "texture", type="skybox", builtin="flat", rgb1="1 1 1", rgb2="1 1 1", width="8", height="8")
    yield from (visual, asset)


def camera(plan: ModelPlan) -> Element:
    """Return a camera that looks at the plane, y being up."""
    middle, width = _view(plan)
    height = _ROOM * width / 2.0 / tan(radians(_ANGLE / 2.0))
    at = f"{shortest(middle.real)} {shortest(middle.imag)} {shortest(height)}"
    return Element("camera", name="plane", pos=at, xyaxes="1 0 0 0 1 0", fovy=shortest(_ANGLE))


def _view(plan: ModelPlan) -> tuple[complex, float]:
    """Return the middle and the width of what is seen: of all poses, where they are known."""
    shown = plan.shown
    seen = np.array([shown.place(link, own) for link, points in shown.points.items() for own in points.values()])
    if shown.motion is not None:
        moved = [np.ravel(shown.motion.points[letter].position) for letter in shown.mechanism.carriers]
        seen = np.concatenate([seen, *moved])
    found = seen * plan.units.length
    sides = [(np.nanmin(part), np.nanmax(part)) for part in (found.real, found.imag)]
    middle = complex(*(float(low + high) / 2.0 for low, high in sides))
    return middle, float(max(*(high - low for low, high in sides), 0.1 * plan.size))
