"""Full turns: the angles of links along a path, and phases of pairs that count turns as they are drawn.

A pose tells the angle of a link within half a turn. Along a path it is followed from home; in a drawing it is as many
turns ahead of the drawn one as its driver is.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from compoundkin.base.arrays import TURN, Number, cross, whole_turns, wrapped
from compoundkin.base.poses import Pose
from compoundkin.base.series import constant
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.curve.driver_path import as_column, drawn_value
from compoundkin.kinematics.curve.group_paths import Followed
from compoundkin.kinematics.driver_values import Inputs
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.pairs.contract import Drivable, Ends, as_turn_counting

# From one sample to the next but one a link turns no farther than this (radians), so that no half a turn is missed;
# and as far as its speed in between says but for the second number: a link that whirls round between two samples gives
# itself away by its speed, though the whole turn does not show in its orientation.
FARTHEST, EVEN = 1.0, 1e-5
# So often an interval is halved at most: 5 degrees of the driver become 0.001.
HALVINGS = 12
# So many places are solved at once.
BLOCK = 4096


@dataclass(frozen=True)
class Turns:
    """The angle of a link at samples of a path: at `places`, (designs, samples), `start` being the sample at home."""

    places: Number
    angles: Number
    start: int

    @property
    def first(self) -> Number:
        """The angle at home, (designs, 1)."""
        return self.angles[:, self.start : self.start + 1]

    def near(self, designs: Number, places: Number) -> Number:
        """Return the angle, right to less than half a turn, at places."""
        after = np.clip(np.searchsorted(self.places, places), 1, max(len(self.places) - 1, 1))
        after = np.minimum(after, len(self.places) - 1)
        before = np.maximum(after - 1, 0)
        nearer = places - self.places[before] < self.places[after] - places
        return self.angles[designs, np.where(nearer, before, after)]


def turns_of(curve: Followed, k: int, link: str, known: tuple[Number, Block] | None = None) -> Turns:
    """Return the angle of a link of group `k`, followed from home, where it is nearest to the drawn one or to zero.

    A driven link is as many turns ahead of its drawn angle as its driver is. `known` is what is solved already at the
    samples of the path, with others half way between.
    """
    places, angles = _Orientation(curve, k, link, known).samples()
    start = int(np.argmin(np.abs(places - curve.path.home)))
    drawn = _drawn_angle(curve, k, link)
    first = angles[:, start] if drawn is None else np.ravel(drawn)
    return Turns(places, _unwrapped(angles, start, first), start)


def _drawn_angle(curve: Followed, k: int, link: str) -> Number | None:
    """Return the angle at which a link of group `k` is drawn, by the turns of its driver. None where it is not."""
    drawn = curve.solving_order.structure.mechanism.drawn_poses
    if link not in drawn:
        return None
    angle = as_column(drawn[link]).angle.c[0]
    body = next(body for body in curve.solving_order.solvers[k].group.bodies if link in body.links)
    if body.links[0] not in drawn or link == body.links[0]:
        return angle
    first = curve.path.at_home()
    local = curve.solving_order.start(first.ends, first.series(0), 0, (first.designs, 1)).local[link]
    return angle + whole_turns(_ahead_of_drawing(drawn, body.links[0], link, local))


def _ahead_of_drawing(drawn: Mapping[str, Pose], base: str, link: str, local: Pose) -> Number:
    """Return the angle of a driven link less its drawn one, from its pose in the base of its composite link."""
    ahead: Number = as_column(drawn[base]).angle.c[0] + local.angle.c[0] - as_column(drawn[link]).angle.c[0]
    return ahead


@dataclass(frozen=True)
class _Orientation:
    """The orientation of a link of group `k` along the path."""

    curve: Followed
    k: int
    link: str
    known: tuple[Number, Block] | None = None

    def samples(self) -> tuple[Number, Number]:
        """Return places and orientations there (radians), the places so near to each other that no turn is missed."""
        at = self.curve.path.samples
        if self.known is None:
            low, found, middle = at, self._at(at, 0)[0], (at[1:] + at[:-1]) / 2.0
            there, speed = self._at(middle, 1)
        else:
            every, (angles, speeds) = self.known[0], self._turning(self.known[1])
            low, found, middle, there, speed = every[::2], angles[:, ::2], every[1::2], angles[:, 1::2], speeds[:, 1::2]
        known = [(low, found)]
        low, high = (low[:-1], found[:, :-1]), (low[1:], found[:, 1:])
        for k in range(HALVINGS):
            if k:
                middle = 0.5 * (low[0] + high[0])
                there, speed = self._at(middle, 1)
            known.append((middle, there))
            halves = wrapped(there - low[1]), wrapped(high[1] - there)
            uneven = np.abs(halves[0] + halves[1] - speed * (high[0] - low[0])) > EVEN
            far = np.maximum(np.abs(halves[0]), np.abs(halves[1])) > FARTHEST / 2.0
            # where an end is not assembled there is nothing to be followed
            rough = np.any((uneven | far) & np.isfinite(halves[0] + halves[1]), axis=0)
            if not rough.any():
                break
            parts = ((low, (middle, there)), ((middle, there), high))
            low, high = (_joined([(s[rough], v[:, rough]) for s, v in side]) for side in zip(*parts, strict=True))
        return _in_order(_joined(known))

    def _at(self, at: Number, order: int) -> tuple[Number, Number]:
        """Return the orientation at places (designs, places), and how fast it turns."""
        designs = np.arange(self.curve.path.designs)[:, None]
        found, speed = np.empty((len(designs), len(at))), np.zeros((len(designs), len(at)))
        for start in range(0, len(at), BLOCK):
            here = slice(start, start + BLOCK)
            block = self.curve.run(self.curve.path.at(at[here]), order, at[here][None], designs, self.k + 1)
            found[:, here], speed[:, here] = self._turning(block)
        return found, speed

    def _turning(self, block: Block) -> tuple[Number, Number]:
        u = block.world[self.link].u.c
        speed = cross(u[0], u[1]) if len(u) > 1 else 0.0
        return np.broadcast_to(np.angle(u[0]), block.shape), np.broadcast_to(speed, block.shape)


def _joined(parts: Sequence[tuple[Number, Number]]) -> tuple[Number, Number]:
    return np.concatenate([s for s, _ in parts]), np.concatenate([v for _, v in parts], axis=1)


def _in_order(samples: tuple[Number, Number]) -> tuple[Number, Number]:
    order = np.argsort(samples[0])
    return samples[0][order], samples[1][:, order]


def _unwrapped(angles: Number, start: int, first: Number) -> Number:
    """Make angles continuous, over gaps too, and at the sample `start` nearest to `first`."""
    known = np.isfinite(angles)
    last = np.maximum.accumulate(np.where(known, np.arange(angles.shape[1]), -1), axis=1)
    held = np.take_along_axis(angles, np.where(last < 0, known.argmax(axis=1)[:, None], last), axis=1)
    out = np.unwrap(np.nan_to_num(held), axis=1)
    return out + whole_turns(np.nan_to_num(first - out[:, start]))[:, None]


def recounted(solving_order: SolvingOrder, ways: tuple[Inputs, ...], pose: Inputs) -> tuple[Inputs, ...]:
    """Return the inputs of a motion and of its path with drawn phases moved on by the turns that drivers have made.

    A drawing shows the angle of a driven link within half a turn; its driver may be any number of turns ahead. `pose`
    has the inputs at which the mechanism is drawn.
    """
    pose, *counted = (_slides_counted(solving_order, way) for way in (pose, *ways))
    drawn, rounds = _as_drawn(solving_order, pose)
    driven = dict(_turns_at(solving_order, _counted_on(solving_order, drawn, rounds, {})))
    turns = _with_stated_turns(solving_order, drawn, driven)
    return tuple(
        _blocks_counted(solving_order, _counted_on(solving_order, way, rounds, turns), turns) for way in counted
    )


def _slides_counted(solving_order: SolvingOrder, way: Inputs) -> Inputs:
    """Return a way with driven blocks that count turns as they are drawn, as phases of what meshes with them do."""
    drawn, ends = solving_order.structure.mechanism.drawn_poses, dict(way.ends)
    slides = [driven.pair for body in solving_order.structure.bodies for driven in body.driven]
    for pair in (
        pair for pair in slides if pair.is_simple and not pair.free_is_angle and drawn.keys() >= {*pair.members}
    ):
        guide, block = (as_column(drawn[k]).angle.c[0] for k in pair.members)
        ends[pair.name] = _with_turns(pair, ends[pair.name], block - guide)
    return replace(way, ends=ends)


def _with_turns(slide: Drivable, ends: Ends, ahead: Number) -> Ends:
    """Return the ends of a slide whose block is ahead of its guide by an angle, known to less than half a turn."""
    turned = slide.placed(ends, constant(0.0)).angle.c[0]
    return ends[0], ends[1]._replace(measure=np.round((ahead - turned) / TURN))


def _blocks_counted(solving_order: SolvingOrder, way: Inputs, turns: Mapping[str, Number]) -> Inputs:
    """Return a way with blocks that count turns as drawn: a slide tells their angle within half a turn only."""
    drawn, ends = solving_order.structure.mechanism.drawn_poses, dict(way.ends)
    for mounted in (mounted for solver in solving_order.solvers for mounted in solver.slid):
        name, links, other = mounted.lower.name, mounted.lower.members, mounted.side.other
        if not drawn.keys() >= set(links):
            continue
        guide, block = (
            as_column(drawn[k]).angle.c[0] + TURN * (turns.get(k, 0.0) if k == other else 0.0) for k in links
        )
        ends[name] = _with_turns(mounted.lower, ends[name], block - guide)
    return replace(way, ends=ends)


def _as_drawn(solving_order: SolvingOrder, pose: Inputs) -> tuple[Inputs, dict[str, Number]]:
    """Return the reference pose with drivers as drawn, in the turn they are in there; and that turn, by driven pair."""
    rounds: dict[str, Number] = {}
    for name, driven in solving_order.structure.driven.items():
        value = drawn_value(solving_order, pose, name, solving_order.structure.mechanism.drawn_poses, {})
        if value is None:
            continue
        if driven.pair.free_is_angle:
            turns = np.round((pose.drives[name][0] - value) / TURN)
            rounds[driven.pair.name] = turns * driven.pair.driven_by(driven.drive.link)
            value = value + TURN * turns
        pose = pose.driven({**pose.drives, name: (value,)})
    return pose, rounds


def _counted_on(
    solving_order: SolvingOrder, way: Inputs, rounds: Mapping[str, Number], turns: Mapping[str, Number]
) -> Inputs:
    """Return a way with phases moved on: of driven pairs by their own turns, of others by the turns of their links."""
    geometry = solving_order.structure.mechanism.geometry
    ends = dict(way.ends)
    for name, pair in solving_order.pairs.items():
        ahead = tuple(turns.get(member, 0.0) for member in pair.members)
        counting = as_turn_counting(pair)
        if counting and name in rounds:
            ends[name] = counting.with_driver_turns(ends[name], geometry, rounds[name])
        elif counting and any(np.any(turn != 0.0) for turn in ahead):
            ends[name] = counting.with_link_turns(ends[name], geometry, ahead)
    return replace(way, ends=ends)


def _with_stated_turns(solving_order: SolvingOrder, drawn: Inputs, turns: Mapping[str, Number]) -> Mapping[str, Number]:
    """Return also by how many turns links are ahead of their drawn angle by stated phases, in the solving order."""
    poses, found = solving_order.structure.mechanism.drawn_poses, dict(turns)
    counting = [
        pair
        for pair in map(as_turn_counting, solving_order.pairs.values())
        if pair and all(k in poses for k in pair.members)
    ]
    last = {link: solver.index for solver in solving_order.solvers for link in solver.group.links}
    for solver in solving_order.solvers:
        mine = [pair for pair in counting if max(last.get(k, -1) for k in pair.members) == solver.index]
        for body in solver.group.bodies:
            for pair in mine:
                own = [i for i, k in enumerate(pair.members) if k in body.links]
                if any(last.get(k, -1) == solver.index and k not in body.links for k in pair.members):
                    continue
                angles = tuple(as_column(poses[k]).angle.c[0] + TURN * found.get(k, 0.0) for k in pair.members)
                ahead = pair.stated_turns(drawn.ends[pair.name], angles, own)
                if np.any(ahead != 0.0):
                    found |= {link: found.get(link, 0.0) + ahead for link in body.links}
                    break
    return found


def _turns_at(solving_order: SolvingOrder, drawn: Inputs) -> Iterator[tuple[str, Number]]:
    """Yield by how many turns each driven link is ahead of its drawn angle, relative to its composite link's base."""
    poses = solving_order.structure.mechanism.drawn_poses
    start = solving_order.start(drawn.ends, drawn.series(0), 0, (drawn.designs, 1))
    for body in solving_order.structure.bodies:
        base = body.links[0]
        for link in (
            link for link in body.links[1:] if link in poses and base in poses and link in solving_order.turning
        ):
            pose = start.world.get(link) or start.local[link]
            yield link, np.round(_ahead_of_drawing(poses, base, link, pose) / TURN)
