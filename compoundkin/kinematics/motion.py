"""A solved motion: points, links, pairs and drivers by name, with all derivatives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial, reduce
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.copies import CopiesFields
from compoundkin.base.display import DisplaysPicture, display_function
from compoundkin.base.poses import Pose
from compoundkin.kinematics.block import Block, with_poses
from compoundkin.kinematics.chosen_modes import GroupMode, modes_of
from compoundkin.kinematics.derived.figures_of_forces import AsksForces
from compoundkin.kinematics.error_estimate import errors_of
from compoundkin.kinematics.inputs import Inputs, PoseGrid, fit
from compoundkin.kinematics.jacobian import Jacobian, jacobian_of
from compoundkin.kinematics.results import LinkMotion, Named, PairMotion, PointMotion
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.kinematics.table import Table, table_of
from compoundkin.kinematics.tracking import Tracker
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure.kinematic_structure import Structure


@dataclass(frozen=True)
class Motion(CopiesFields, DisplaysPicture, AsksForces):
    """A mechanism solved: every link's pose with all derivatives, over designs and poses.

    `shape` is the broadcast shape of dimensions and driver values, the last axis the motion. Poses that cannot be
    assembled are NaN, False in `assembled`, and explained by `compoundkin.kinematics.gaps`.
    """

    structure: Structure
    order: int
    inputs: Inputs
    poses: Mapping[str, Pose]
    failed: Number  # shape (designs, poses): index of the first group that does not close plus one, or 0
    tracker: Tracker
    time: Number | None = None  # the times (seconds) of a motion in time; broadcasts with its shape
    loading: Mapping[str, Any] = field(default_factory=dict)  # how its forces are asked for: of `force_analysis`
    is_whole: ClassVar[bool] = True  # whether its poses are those that its tracker has noted, not places between them

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism that was solved."""
        return self.structure.mechanism

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
        found = self._errors[order]
        for pose in self.poses.values() if order else ():
            for series in (pose.z, pose.u):
                found = np.where(np.isfinite(series.c[min(order, series.order)]), found, np.inf)
        return self.grid.known(found)

    @cached_property
    def _errors(self) -> list[Number]:
        with np.errstate(all="ignore"):
            return errors_of(self.tracker, self.inputs, self.order)

    @property
    def size(self) -> float:
        """The mechanism's length scale."""
        return self.solving_order.size

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
        return self.tracker.solving_order

    @property
    def modes(self) -> Mapping[str, GroupMode]:
        """The assembly mode of every group, by the group's name in configurations."""
        return modes_of(self.solving_order, self.chosen_by, self.tracker.sign, self.shape[:-1])

    @property
    def chosen_by(self) -> Mapping[int, str]:
        """What chose the mode of each group: `sign`, `drawing`, `hint`, `default` or another."""
        return self.tracker.chosen_by

    @property
    def change_points(self) -> Mapping[int, Number]:
        """Where groups are at change points, (designs, count), padded with inf. Twice where the motion turns back."""
        return self.tracker.flips

    def sign(self, k: int, design: int) -> int:
        """Return the sign of a group's mode at the first pose of a design."""
        return int(np.ravel(self.tracker.sign(k, np.array([[design]]), np.array([[0.0]])))[0])

    def block(self, part: Inputs, order: int, s: Number, designs: Number) -> Block:
        """Solve other inputs in the configuration at places `s` of `designs` (indices)."""
        return self.tracker.run(part, order, s, designs)

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
