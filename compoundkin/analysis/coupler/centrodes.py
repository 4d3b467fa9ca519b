"""The pole of two links at every pose, and the centrodes it runs along."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.analysis.coupler.relative_motion import (
    INFINITE,
    UNKNOWN,
    RelativeMotion,
    relative_motion,
    series_rate,
    unit_direction,
)
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, cross
from compoundkin.base.display import ShortRepr
from compoundkin.base.series import Series
from compoundkin.kinematics import Motion
from compoundkin.kinematics.derived.velocity_ratio import SMALL
from compoundkin.model.geometry import FRAME


@dataclass(frozen=True, eq=False, repr=False)
class Pole(ShortRepr):
    """The pole (relative instant centre) of two links at every pose. Arrays of the motion's shape.

    `fixed`, `moving`, `world`: complex, in the frame of the observing link, of the moving link and of the mechanism.
    Where the pole is at infinity (`infinite`) they are inf, and `direction` is the unit vector towards it, up to its
    sign, in the observing link's frame; elsewhere `direction` is 0. Where `defined` is False all are NaN: the pose is
    not assembled, its rates are infinite, or the links stand still relative to each other.
    """

    fixed: Number
    moving: Number
    world: Number
    direction: Number
    infinite: Number
    defined: Number

    @property
    def homogeneous(self) -> Number:
        """Coordinates (x, y, w) of `fixed` in a last axis of length 3. W is 1, or 0 for a pole at infinity."""
        place: Number = np.where(self.infinite, self.direction, self.fixed)
        weight = np.where(self.defined, np.where(self.infinite, 0.0, 1.0), np.nan)
        return np.stack([place.real, place.imag, weight], axis=-1)


@dataclass(frozen=True, eq=False, repr=False)
class Centrodes(ShortRepr):
    """The two paths of a pole, and its velocities along them: the moving centrode rolls on the fixed one.

    `fixed` is the locus of the pole in the observing link's frame, `moving` that in the moving link's frame, pose by
    pose. `fixed_velocity`, `moving_velocity` (length/s) are the pole's velocities along them, each in its own link's
    axes; their equal lengths and common tangent mean rolling. They are inf where the pole is at infinity, and NaN where
    it is not defined or is a limit (the links stand still for an instant).
    """

    pole: Pole
    fixed_velocity: Number
    moving_velocity: Number

    @property
    def fixed(self) -> Number:
        """The fixed centrode."""
        return self.pole.fixed

    @property
    def moving(self) -> Number:
        """The moving centrode."""
        return self.pole.moving


@checked
@np.errstate(all="ignore")
def pole(motion: Motion, link: str, on: str = FRAME) -> Pole:
    """Return the point of `link` without velocity in the frame of `on`, at every pose.

    Lengths in the user's unit. It depends on the geometry only, not on the driver's speed. Where the links stand still
    for an instant (a rocker at the end of its swing) the limit is taken from the second derivatives, if the motion has
    them. Raises UnknownName, and InvalidInput for order 0, a link seen from itself or a driver at rest.
    Source: Bottema and Roth, Theoretical Kinematics, chapter VIII: ``P = z + i z' / omega``.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> motion = solve(load("elliptic-trammel"), {"rod": [np.pi / 2, 0.0]})
    >>> pole(motion, "rod").world.round(9).tolist()
    [3j, (-3+0j)]
    >>> abs(pole(motion, "slider-a").direction.imag).round(9).tolist()     # at right angles to its guide
    [1.0, 1.0]
    """
    return _pole(relative_motion(motion, link, on, 1, "the pole"))


@checked
@np.errstate(all="ignore")
def pole_velocity(motion: Motion, link: str, on: str = FRAME) -> Number:
    """Return the velocity of the pole along the fixed centrode (pole change velocity), in the frame of `on`.

    Complex, length/s, of the motion's shape; inf where the pole is at infinity, NaN where it is not defined or a limit
    (see `pole`). Proportional to the driver's speed. Raises as `pole`, and InvalidInput below order 2.
    Source: E. A. Dijksman, Motion Geometry of Mechanisms (1976).

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> motion = solve(load("elliptic-trammel"), {"rod": [np.pi / 2]}, speed=-1.0)
    >>> abs(pole_velocity(motion, "rod")).round(9).tolist()
    [3.0]
    """
    seen = relative_motion(motion, link, on, 2, "the pole's velocity")
    return _change(seen, seen.pole)


@checked
@np.errstate(all="ignore")
def centrodes(motion: Motion, link: str, on: str = FRAME) -> Centrodes:
    """Return the fixed and the moving centrode of `link` seen from `on`.

    Complex arrays of the motion's shape, lengths in the user's unit. The curves depend on the geometry only, the
    velocities along them on the driver's. Raises as `pole`, and InvalidInput below order 2.
    Source: Dijksman, Motion Geometry of Mechanisms; the rolling is due to Cauchy and Poinsot.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> trammel = centrodes(solve(load("elliptic-trammel")), "rod")
    >>> abs(trammel.fixed).round(9)[:2].tolist(), abs(trammel.moving - 1.5).round(9)[:2].tolist()     # Cardan's circles
    ([3.0, 3.0], [1.5, 1.5])
    """
    seen = relative_motion(motion, link, on, 2, "the centrodes")
    return Centrodes(_pole(seen), _change(seen, seen.pole), _change(seen, _moving(seen)))


@checked
@np.errstate(all="ignore")
def centrode_curvature(motion: Motion, link: str, on: str = FRAME) -> tuple[Number, Number]:
    """Return the curvatures (1/length) of both centrodes at the pole.

    Positive where the curve bends to the left as the pole runs along it while the links turn counterclockwise, so that
    neither depends on the driver. ``fixed - moving = 1/diameter of the inflection circle``. NaN where the pole is at
    infinity, not defined, a limit, or does not move (a pin). Raises as `pole`, and InvalidInput below order 3.
    Source: Dijksman, Motion Geometry of Mechanisms, the second equation of Euler and Savary.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> fixed, moving = centrode_curvature(solve(load("elliptic-trammel"), order=3), "rod")
    >>> (1 / fixed).round(9)[:2].tolist(), (1 / moving).round(9)[:2].tolist()     # the pole runs against the rod's turn
    ([-3.0, -3.0], [-1.5, -1.5])
    """
    seen = relative_motion(motion, link, on, 3, "the curvature of the centrodes")
    omega = Series(seen.omega.c[:-1])
    return _bend(seen, seen.pole_by_angle, omega), _bend(seen, series_rate(_moving(seen)) / omega, omega)


def pole_moves(seen: RelativeMotion) -> Number:
    """Return whether the pole moves by more than rounding; of pinned links it does not."""
    return seen.turning & (np.abs(seen.pole_by_angle.c[0]) > seen.noise)


def _pole(seen: RelativeMotion) -> Pole:
    number, weight = _leading(seen)
    infinite = np.abs(weight) * seen.reach <= SMALL * np.abs(number)
    defined = seen.regular & np.isfinite(number) & ((weight != 0) | infinite & (number != 0))
    infinite = infinite & defined
    fixed = np.where(infinite, INFINITE, seen.masked(number / weight, defined))
    return Pole(
        fixed,
        np.where(infinite, INFINITE, np.conj(seen.u.c[0]) * (fixed - seen.z.c[0])),
        np.where(infinite, INFINITE, np.asarray(seen.motion.links[seen.on].at(fixed).position)),
        seen.masked(np.where(infinite, unit_direction(number), 0j), defined),
        infinite,
        defined,
    )


def _leading(seen: RelativeMotion) -> tuple[Number, Number]:
    """Return the pole as a fraction, from the next derivatives (l'Hopital's rule) where the links stand still."""
    number, weight = seen.numerator.c, seen.omega.c
    if len(weight) == 1:
        return seen.masked(number[0], ~seen.resting), weight[0]
    noise = SMALL * seen.scale(2)
    still = seen.resting & (np.abs(weight[1]) <= noise) & (np.abs(number[1]) <= noise * seen.reach)
    second = np.where(np.abs(weight[1]) > noise, weight[1], 0.0)
    return seen.masked(np.where(seen.resting, number[1], number[0]), ~still), np.where(seen.resting, second, weight[0])


def _moving(seen: RelativeMotion) -> Series:
    """Return the pole in the moving link's own frame."""
    order = len(seen.pole.c)
    return Series(seen.u.c[:order]).conj() * (seen.pole - Series(seen.z.c[:order]))


def _change(seen: RelativeMotion, place: Series) -> Number:
    infinite = seen.regular & ~seen.turning & ~seen.resting
    return np.where(infinite, INFINITE, np.where(seen.turning, place.derivative(1), UNKNOWN))


def _bend(seen: RelativeMotion, by_angle: Series, omega: Series) -> Number:
    """Return the curvature of a curve from its derivative by the relative angle."""
    first, second = by_angle.c[0], series_rate(by_angle).c[0] / omega.c[0]
    return seen.masked(cross(first, second) / np.abs(first) ** 3, pole_moves(seen))
