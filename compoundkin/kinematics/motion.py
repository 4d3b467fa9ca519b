"""A solved motion: points, links, pairs and drivers by name with all derivatives, and its rounding error."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial, reduce
from math import factorial
from typing import Any, ClassVar, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number, Vectors, unwrapped
from compoundkin.base.copies import CopiesFields
from compoundkin.base.display import DisplaysPicture, display_function
from compoundkin.base.errors import ExplainsAttributes, Problem, UnknownName, nearest, suggestion
from compoundkin.base.poses import FIXED, End, Pose
from compoundkin.base.series import Series
from compoundkin.kinematics.block import BLOCK, Block, blocks, places, repeated, size_in, with_poses
from compoundkin.kinematics.curve.double_roots import rates_at
from compoundkin.kinematics.curve.followed_poses import FollowedPoses
from compoundkin.kinematics.curve.modes import GroupMode, modes_of
from compoundkin.kinematics.derived.contract import AsksForces
from compoundkin.kinematics.driver_values import Inputs, PoseGrid, fit
from compoundkin.kinematics.jacobian import Jacobian, jacobian_of
from compoundkin.kinematics.quantities import Table, names_meant, quantity, table_of
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.attributes import CATALOGUE, DERIVED
from compoundkin.model.geometry import vector
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure.kinematic_structure import Structure


@dataclass(frozen=True)
class Motion(CopiesFields, DisplaysPicture, AsksForces, ExplainsAttributes):
    """A mechanism solved: every link's pose with all derivatives, over designs and poses.

    `shape` is the broadcast shape of dimensions and driver values, the last axis the motion. Poses that cannot be
    assembled are NaN, False in `assembled`, and explained by `compoundkin.kinematics.gaps`.
    """

    structure: Structure
    order: int
    inputs: Inputs
    poses: Mapping[str, Pose]
    failed: Number  # shape (designs, poses): index of the first group that does not close plus one, or 0
    followed: FollowedPoses  # on the configuration curve
    time: Number | None = None  # the times (seconds) of a motion in time; broadcasts with its shape
    loading: Mapping[str, Any] = field(default_factory=dict)  # how its forces are asked for: of `force_analysis`
    is_whole: ClassVar[bool] = True  # whether its poses are those that are noted on its curve, not places between them

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism that was solved."""
        return self.structure.mechanism

    def __getitem__(self, name: str) -> PointMotion | LinkMotion | PairMotion | Number:
        """Return the motion of a point, link, pair or driver by its name, or the numbers of a quantity.

        Raises UnknownName with the nearest.

        >>> from compoundkin.model.elements import drive, link
        >>> from compoundkin.kinematics import solve
        >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
        >>> motion = solve(crank, {"crank": [0.0]}, speed=3.0)
        >>> motion["crank"].angular_velocity, motion["B.velocity"]
        (array([3.]), array([0.+6.j]))
        """
        for kind in (self.links, self.points, self.pairs, self.drives):
            if name in kind:
                return kind[name]
        found: Number = quantity(self, name).values
        return found

    # so that what is no sequence is not taken for one
    __iter__: ClassVar[None] = None

    def _instead(self, name: str) -> str:
        kinds = [kind for kind in ("links", "points", "pairs", "drives") if name in getattr(self, kind)]
        if kinds:
            return f"write motion.{kinds[0]}[{name!r}]"
        asked = names_meant(self, name)
        return f"write compoundkin.quantity(motion, {' or '.join(map(repr, asked))})" if asked else ""

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of every array of the motion."""
        return self.inputs.shape

    @cached_property
    def grid(self) -> PoseGrid:
        """How its numbers are shown."""
        return PoseGrid(self.shape, self.order, self.failed)

    @cached_property
    def assembled(self) -> Number:
        """Which poses are assembled, a bool array of the motion's shape."""
        return self.grid.shaped(self.failed == 0)

    @cached_property
    def regular(self) -> Number:
        """Which poses have finite rates, (designs, poses): the assembled ones but for limit positions."""
        good = np.array(self.failed == 0)
        rates = [c for pose in self.poses.values() for c in (*pose.z.c[1:], *pose.u.c[1:])]
        return np.asarray(reduce(lambda found, rate: found & np.isfinite(rate), rates, good))

    def error(self, order: int = 0) -> Number:
        """Return about how much error rounding leaves in a derivative, at every pose.

        Of any link's origin, or its orientation times the size. NaN where a pose is not assembled, infinite where rates
        have no digit. It takes nine times the solution, when first asked for.

        >>> from compoundkin.model.elements import drive, link
        >>> from compoundkin.kinematics import solve
        >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
        >>> bool(solve(crank, {"crank": [1.0]}).error(1)[0] < 1e-14)
        True
        """
        self.grid.require(order)
        return self.grid.known(np.where(self._finite[order], self._errors[order], np.inf) if order else self._errors[0])

    @cached_property
    def _finite(self) -> list[Number]:
        """Where all links have a finite derivative, of each order."""
        found: list[Number] = [np.True_] * (self.order + 1)
        for pose in self.poses.values():
            for series in (pose.z, pose.u):
                for k in range(1, self.order + 1):
                    found[k] = found[k] & np.isfinite(series.c[min(k, series.order)])
        return found

    @cached_property
    def _errors(self) -> list[Number]:
        with np.errstate(all="ignore"):
            return errors_of(self.followed, self.inputs, self.order)

    @property
    def size(self) -> float:
        """The mechanism's length scale, that of the greatest design."""
        return self.solving_order.size

    @cached_property
    def sizes(self) -> Number:
        """The length scale of each design, (designs, 1); a number if all share it."""
        return size_in(self.inputs.ends, self.size)

    @cached_property
    def points(self) -> Mapping[str, PointMotion]:
        """The motion of every point by its letter."""
        return Named("point", tuple(self.mechanism.carriers), self._point)

    @cached_property
    def links(self) -> Mapping[str, LinkMotion]:
        """The motion of every link by its name."""
        return Named("link", tuple(self.mechanism.links), self._link)

    @cached_property
    def pairs(self) -> Mapping[str, PairMotion]:
        """The relative motion in every pair by its name."""
        return Named("pair", tuple(self.solving_order.pairs), self._pair)

    @cached_property
    def drives(self) -> Mapping[str, PairMotion]:
        """The prescribed coordinate of every driver by its name."""
        return Named("driver", tuple(self.inputs.drives), self._drive)

    def table(self, *names: str) -> Table:
        """Return the quantities of these names as columns; everything without names.

        Designs, time and drivers stand beside them.

        >>> from compoundkin.model.elements import drive, link
        >>> from compoundkin.kinematics import solve
        >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"), unit="mm")
        >>> solve(crank, {"crank": [0.0, 1.0]}).table("B.x")["B.x"]
        Quantity('B.x', x(B), 2 values in mm)
        """
        return table_of(self, *names)

    def to_pandas(self, *names: str) -> Any:
        """Return the table of these quantities as a pandas DataFrame, angles in radians."""
        return table_of(self, *names).to_pandas()

    def jacobian(self, *outputs: str) -> Jacobian:
        """Return how fast outputs move at every pose when each driver moves alone.

        It has unit speed. Outputs are places and angles by name, "G" (two rows), "bar.angle", "ram.displacement",
        else those of the mechanism. Solved, not differenced. Raises UnknownName, InvalidInput for what is a rate.

        >>> from compoundkin.model.elements import drive, link
        >>> from compoundkin.kinematics import solve
        >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"), unit="mm")
        >>> found = solve(crank, {"crank": [0.0]}).jacobian("B", "crank.angle")
        >>> found, found.matrix.tolist()
        (Jacobian(B.x, B.y, crank.angle by crank at (1,) poses), [[[0.0], [2.0], [1.0]]])
        """
        return jacobian_of(self, *outputs)

    def plot(self, *names: str, **options: Any) -> Any:
        """Draw quantities over the driver, the time or any other quantity. `compoundkin.plot` of this motion."""
        return display_function("plot")(self, *names, **options)

    def animate(self, **options: Any) -> Any:
        """Return an animation to be saved as GIF, MP4 or SVG. `compoundkin.animate` of this motion."""
        return display_function("animation")(self, **options)

    @property
    def solving_order(self) -> SolvingOrder:
        """What solved it: the driven links, then a solver for each group."""
        return self.followed.solving_order

    @property
    def modes(self) -> Mapping[str, GroupMode]:
        """The assembly mode of every group, by the group's name in configurations."""
        return modes_of(self.solving_order, self.chosen_by, self.followed.sign, self.shape[:-1])

    @property
    def chosen_by(self) -> Mapping[int, str]:
        """What chose the mode of each group: `sign`, `drawing`, `hint`, `default` or another."""
        return self.followed.curve.chosen_by

    @property
    def change_points(self) -> Mapping[int, Number]:
        """Where groups are at change points, (designs, count), padded with inf. Twice where the motion turns back."""
        return self.followed.change_points

    def sign(self, k: int, design: int) -> int:
        """Return the sign of a group's mode at the first pose of a design."""
        return int(np.ravel(self.followed.sign(k, np.array([[design]]), np.array([[0.0]])))[0])

    def block(self, part: Inputs, order: int, s: Number, designs: Number) -> Block:
        """Solve other inputs in the configuration at places `s` of `designs` (indices)."""
        return self.followed.run(part, order, s, designs)

    def mended(self, designs: Number, index: Number, poses: Mapping[str, Pose]) -> Motion:
        """Return the motion with some poses in the place of what was solved."""
        known = self.poses, self.failed.shape, self.order, (designs, index)
        return replace(self, poses=with_poses(*known, poses)) if len(index) else self

    def __repr__(self) -> str:
        told = f", {missing} of them not assembled" if (missing := int(np.count_nonzero(self.failed))) else ""
        return f"Motion({self.mechanism.title!r} at {self.shape} poses to order {self.order}{told})"

    def _link(self, name: str) -> LinkMotion:
        return LinkMotion(self.grid, self.poses[name], name)

    def _point(self, name: str) -> PointMotion:
        link = self.mechanism.carriers[name][0]
        p = fit(self.shape)(self.mechanism.geometry.points[link][name])
        return PointMotion(self.grid, partial(self.poses[link].derivative, p), name)

    def _pair(self, name: str) -> PairMotion:
        pair, ends = self.solving_order.pairs[name], self.inputs.ends[name]
        poses = tuple(self.poses[member] for member in pair.members)
        counted = all(pose.theta is not None for pose in poses)
        return PairMotion(self.grid, pair.coordinate(ends, poses), pair.free_is_angle, counted=counted)

    def _drive(self, name: str) -> PairMotion:
        is_angle = self.structure.driven_angles[name]
        return PairMotion(self.grid, self.inputs.series(self.order)[name], is_angle, prescribed=True)


class PointMotion(ExplainsAttributes):
    """The motion of a point: complex arrays of the motion's shape. `.xy` of each gives (..., 2)."""

    def __init__(self, grid: PoseGrid, derivative: Any, name: str = "") -> None:
        self._grid, self._name = grid, name
        self._derivative = derivative

    def derivative(self, k: int) -> Vectors:
        """Return the k-th time derivative of the position. Raises InvalidInput beyond the order solved for."""
        self._grid.require(k)
        found: Vectors = self._grid.known(self._derivative(k)).astype(complex, copy=False).view(Vectors)
        return found

    @property
    def position(self) -> Vectors:
        """Where it is, in the user's length unit."""
        return self.derivative(0)

    @property
    def velocity(self) -> Vectors:
        """Its velocity, length/s."""
        return self.derivative(1)

    @property
    def acceleration(self) -> Vectors:
        """Its acceleration, length/s^2."""
        return self.derivative(2)

    @property
    def jerk(self) -> Vectors:
        """Its jerk, length/s^3."""
        return self.derivative(3)

    @property
    def x(self) -> Number:
        """The first coordinate of its position."""
        return np.asarray(self.position.real)

    @property
    def y(self) -> Number:
        """The second coordinate of its position."""
        return np.asarray(self.position.imag)

    @property
    def speed(self) -> Number:
        """The length of its velocity."""
        return np.abs(np.asarray(self.velocity))

    def __repr__(self) -> str:
        return described(self, self._grid, self._name)


class LinkMotion(ExplainsAttributes):
    """The motion of a link. Its angle from the frame's x axis, and that of any of its points."""

    def __init__(self, grid: PoseGrid, pose: Pose, name: str = "") -> None:
        self._grid, self._name = grid, name
        self._pose = pose

    def _instead(self, name: str) -> str:
        own = name if name in DERIVED["links"] else next(iter(nearest(name, list(DERIVED["links"]))), "")
        has_own = bool(nearest(name, list(CATALOGUE["links"])))
        return f"write compoundkin.quantity(motion, '{self._name}.{own}')" if own and not has_own else ""

    @cached_property
    def _turning(self) -> Series:
        return self._pose.u.turning()

    def _rate(self, k: int) -> Number:
        self._grid.require(k)
        if k:
            return self._grid.known(self._turning.derivative(k - 1))
        return self._grid.known(self._pose.angle.c[0])

    @cached_property
    def angle(self) -> Number:
        """The angle of its x axis, radians, unwrapped along the motion.

        A driven link or a gear has it as it is counted.
        """
        return unwrapped(self._rate(0)) if self._pose.theta is None else self._rate(0)

    @property
    def angular_velocity(self) -> Number:
        """Its angular velocity, rad/s."""
        return self._rate(1)

    @property
    def angular_acceleration(self) -> Number:
        """Its angular acceleration, rad/s^2."""
        return self._rate(2)

    @property
    def angular_jerk(self) -> Number:
        """Its angular jerk, rad/s^3."""
        return self._rate(3)

    @property
    def origin(self) -> PointMotion:
        """The motion of the origin of its frame."""
        return PointMotion(self._grid, self._pose.z.derivative)

    def at(self, point: Any) -> PointMotion:
        """Return the motion of any point given in its frame, complex or (x, y)."""
        p = self._grid.fitted(vector("point", point))
        return PointMotion(self._grid, partial(self._pose.derivative, p))

    def __repr__(self) -> str:
        return described(self, self._grid, self._name)


class PairMotion(ExplainsAttributes):
    """The free relative coordinate of a pair.

    It is an angle (radians, unwrapped) or a displacement, and has its rates.
    """

    def __init__(
        self, grid: PoseGrid, coordinate: Series, is_angle: bool, prescribed: bool = False, counted: bool = False
    ) -> None:
        self._grid = grid
        self._prescribed = prescribed
        self._counted = counted or prescribed
        self.coordinate = coordinate
        self.is_angle = is_angle

    def derivative(self, k: int) -> Number:
        """Return the k-th time derivative; raises InvalidInput beyond the order solved for."""
        self._grid.require(k)
        value = self.coordinate.derivative(k)
        value = self._grid.shaped(value) if self._prescribed else self._grid.known(value)
        return unwrapped(value) if k == 0 and self.is_angle and not self._counted else value

    @property
    def value(self) -> Number:
        """The relative angle or displacement."""
        return self.derivative(0)

    @property
    def rate(self) -> Number:
        """Its first time derivative."""
        return self.derivative(1)

    @property
    def second(self) -> Number:
        """Its second time derivative."""
        return self.derivative(2)

    @property
    def third(self) -> Number:
        """Its third time derivative."""
        return self.derivative(3)

    def __repr__(self) -> str:
        return described(self, self._grid, "angle" if self.is_angle else "displacement")


class Named(Mapping[str, Any], ExplainsAttributes):
    """Entries made when they are asked for. An unknown name raises UnknownName with the nearest known."""

    def __init__(self, kind: str, names: tuple[str, ...], make: Any) -> None:
        self._kind, self._names, self._make = kind, names, make
        self._made: dict[str, Any] = {}

    def __getstate__(self) -> dict[str, Any]:
        # all entries, for what makes them may be a function within another, which cannot be pickled
        return {"_kind": self._kind, "_names": self._names, "_make": None, "_made": dict(self)}

    def __getitem__(self, name: str) -> Any:
        if name not in self._made:
            if name not in self._names:
                raise UnknownName(
                    Problem(str(name), f"there is no such {self._kind}", suggestion(str(name), self._names))
                )
            self._made[name] = self._make(name)
        return self._made[name]

    def _instead(self, name: str) -> str:
        return f"write [{name!r}]" if name in self._names else ""

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def __iter__(self) -> Any:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        more = f", ... {len(self)} in all" if len(self) > 6 else ""
        return f"Named({self._kind}: {', '.join(self._names[:6])}{more})"


def described(part: object, grid: PoseGrid, name: str) -> str:
    """Return what is told of a part of a motion in short. It has its name, shape and order."""
    named = f"{name}: " if name else ""
    return f"{type(part).__name__}({named}{grid.shape} poses to order {grid.order})"


# Half a unit in the last place: what one rounding may do.
ROUNDING = float(np.finfo(float).eps) / 2.0


# So many times the motion is solved again: fewer would now and then agree by chance.
COPIES = 8


# So many times the root mean square of the differences the error hardly ever exceeds: against forty digits it does in
# no sample in a hundred, and is a hundred times less in few.
SAFETY = 2.5


SEED = 20261122


# By link: the errors of the derivatives 0 .. order, each an array of the poses that were solved again.
LinkErrors: TypeAlias = dict[str, list[Number]]


def errors_of(followed: FollowedPoses, given: Inputs, order: int) -> list[Number]:
    """Return the largest error of any link in each derivative, (designs, poses) each."""
    found = [np.zeros((given.designs, given.poses)) for _ in range(order + 1)]
    for d, m in blocks(given.designs, given.poses):
        part = errors_at(followed, given.cut(d, m), order, *places(d, m))
        for whole, errors in zip(found, _largest(part, order), strict=True):
            whole[d, m] = errors
    if followed.expanded is not None:
        designs, index, poses = rates_at(given, followed, order)
        if len(designs):
            part = _differences(
                lambda other, _: rates_at(other, followed, order)[2],
                given,
                poses,
                order,
                followed.solving_order,
                designs,
            )
            for whole, errors in zip(found, _largest(part, order), strict=True):
                whole[designs, index] = np.broadcast_to(errors, (len(designs), 1))[:, 0]
    return found


def errors_at(followed: FollowedPoses, given: Inputs, order: int, s: Number, designs: Number) -> LinkErrors:
    """Return the error of every link at a block of inputs.

    Of the origin in lengths, of the orientation in radians times the mechanism's size: whichever is larger. Infinite
    for rates where a change by rounding leads to a limit position.
    """
    rows, poses = np.broadcast_shapes(s.shape, designs.shape)

    def again(other: Inputs, copies: int = 1) -> Mapping[str, Pose]:
        return followed.run(other, order, repeated(s, copies), np.tile(designs, (copies, 1))).world

    # few poses of many links take as long as one pose does: all copies are solved in one run
    at_once = COPIES if COPIES * rows * poses <= BLOCK else 1
    return _differences(again, given, again(given), order, followed.solving_order, copies=(at_once, rows))


def _largest(errors: LinkErrors, order: int) -> Iterator[Number]:
    """Yield the largest error of any link in each derivative."""
    for k in range(order + 1):
        worst: Number = 0.0
        for found in errors.values():
            worst = np.maximum(worst, found[k])
        yield worst


def _differences(
    again: Callable[[Inputs, int], Mapping[str, Pose]],
    given: Inputs,
    poses: Mapping[str, Pose],
    order: int,
    solving_order: SolvingOrder,
    designs: Number | None = None,
    copies: tuple[int, int] = (1, 1),
) -> LinkErrors:
    """Return how far links are from where they are when dimensions change by rounding.

    The poses are those of the inputs, or a column of some designs. `copies` tells how many are solved at once, and how
    many designs each has.
    """
    rng, size = np.random.default_rng(SEED), size_in(given.ends, solving_order.size)
    size = size if designs is None or not np.ndim(size) else size[designs]
    at_once, rows = copies
    moving = {link: pose for link, pose in poses.items() if pose is not FIXED}
    squares: dict[str, list[Number]] = {link: [0.0] * (order + 1) for link in moving}
    closed: dict[str, list[Number]] = {link: [0.0] * (order + 1) for link in moving}
    with np.errstate(all="ignore"):
        for _ in range(COPIES // at_once):
            others = again(_rounded(given, solving_order, rng, at_once, rows), at_once)
            for link, pose in moving.items():
                other = others[link] if at_once == 1 else others[link].mapped(partial(_by_copies, at_once, rows))
                for k in range(order + 1):
                    gap = _gap(pose, other, k, size)
                    if at_once > 1 and not np.ndim(gap):
                        # links that stand still have no rates
                        gap = np.full(at_once, gap)
                    known = np.isfinite(gap)
                    square = np.where(known, gap, 0.0) ** 2
                    if at_once > 1:
                        square, known = np.add.accumulate(square)[-1], np.count_nonzero(known, axis=0)
                    squares[link][k] = squares[link][k] + square
                    closed[link][k] = closed[link][k] + known
        return {
            link: [SAFETY * np.sqrt(_mean(squares[link][k], closed[link][k], k)) for k in range(order + 1)]
            for link in moving
        }


def _by_copies(copies: int, rows: int, series: Series) -> Series:
    """Return a series of designs of several copies with an axis of the copies, the first."""

    def parted(c: Number) -> Number:
        if np.ndim(c) and len(c) > 1:
            return c.reshape(copies, rows, -1)
        # all copies share it
        return np.broadcast_to(c, (copies, 1, np.shape(c)[-1] if np.ndim(c) else 1))

    return Series(tuple(map(parted, series.c)))


def _mean(squares: Number, closed: Number, k: int) -> Number:
    """Return the mean over the copies. One that is beyond a limit says nothing of poses, that rates have no digit."""
    return np.where(closed > (COPIES - 1 if k else 0), squares / closed, np.inf)


def _gap(one: Pose, other: Pose, k: int, size: Number) -> Number:
    """Return by how much two poses of a link differ in a derivative."""
    away: Number = np.abs(_coefficient(one.z, k) - _coefficient(other.z, k))
    turned: Number = np.abs(_coefficient(one.u, k) - _coefficient(other.u, k)) * size
    return np.maximum(away, turned) * factorial(k)


def _coefficient(series: Series, k: int) -> Number:
    return series.c[k] if k < len(series.c) else 0.0


def _rounded(given: Inputs, solving_order: SolvingOrder, rng: np.random.Generator, copies: int, rows: int) -> Inputs:
    """Return inputs whose every dimension is changed by rounding: of the size, or of itself if it is larger.

    Each of several copies is changed on its own; they stand one after another, each of so many designs.
    """
    given = given if copies == 1 else given.repeated(copies)
    size = size_in(given.ends, solving_order.size)
    # not the ends of guides, which change no pose
    sides_of = {*solving_order.pairs, *(name for solver in solving_order.solvers for name in solver.ends)}
    changing = {name: ends for name, ends in given.ends.items() if name in sides_of}
    count = sum(
        2 + (end.direction is not None) + (end.measure is not None) for ends in changing.values() for end in ends
    )
    noise = iter((ROUNDING * rng.uniform(-1.0, 1.0, (copies, count))).T)

    def drawn() -> Number:
        found = next(noise)
        return float(found[0]) if copies == 1 else np.repeat(found, rows)[:, None]

    def changed(end: End) -> End:
        place: Number = end.point
        point = place + np.maximum(np.abs(place), size) * (drawn() + 1j * drawn())
        direction = None if end.direction is None else end.direction * (1.0 + 1j * drawn())
        measure = None if end.measure is None else end.measure * (1.0 + drawn())
        return end._replace(point=point, direction=direction, measure=measure)

    ends = {name: tuple(map(changed, sides)) for name, sides in changing.items()}
    return replace(given, ends={**given.ends, **ends})
