"""Analysis of a cam over a motion: pressure angle, radii of curvature, sliding, and faults of its profile."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, dot
from compoundkin.base.display import DisplaysHtml
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.kinematics import Motion
from compoundkin.kinematics.derived.guides import direction_of, pressure_angle, velocity_at
from compoundkin.model.pairs.profile_contact import ProfileContact, as_profile_contact

# Greater pressure angles (degrees) load the guide or the pivot too much. Source: R. L. Norton, Cam Design and
# Manufacturing Handbook, 2nd ed., Industrial Press 2009, section 7.1.
TRANSLATING, OSCILLATING = 30.0, 35.0
# The contact is close to an end of an open profile within this part of it.
LEFT = 0.02


@dataclass(frozen=True, eq=False)
class CamAnalysis(DisplaysHtml):
    """A cam pair over a motion. Arrays are of the motion's shape, NaN where it is not assembled.

    Angles in radians. `pressure_angle` is from the direction in which the follower can move (the velocity of its
    contact point, or of the roller's middle) to the common normal, counterclockwise; a radius of curvature is negative
    in a hollow, infinite where the profile is straight. `sliding` is the velocity of the follower past the profile at
    the contact, along the tangent that lies a right angle counterclockwise from the normal towards the follower, as if
    the roller did not turn in its pin. `profile` and `pitch_curve` (None for a flat face) are points in the cam's
    frame.
    """

    motion: Motion
    pair: ProfileContact
    follower: str
    oscillates: bool | None  # None where the follower is not guided by a single pin or slide
    contact: Number
    contact_on_cam: Number
    parameter: Number
    pressure_angle: Number
    radius_of_curvature: Number
    pitch_radius: Number | None
    sliding: Number

    @property
    def profile(self) -> Number:
        """Points of the profile in the cam's frame, in order."""
        return self.pair.curve.samples.points

    @cached_property
    def pitch_curve(self) -> Number | None:
        """The path of the roller's centre, or the knife edge, in the cam's frame. None for a flat face."""
        if self.pair.is_flat:
            return None
        curve = self.pair.curve
        return (
            curve.at(curve.samples.s).c[0] + curve.normal(curve.samples.s).c[0] * self.pair.outward * self.pair.roller
        )

    @property
    def roller_rate(self) -> Number | None:
        """The angular velocity of the roller in its pin if it rolls without sliding. None without a roller."""
        return self.sliding / self.pair.roller if self.pair.roller else None

    @property
    def undercut(self) -> tuple[tuple[float, float], ...]:
        """The intervals of the parameter where the profile is undercut."""
        return self.pair.hollows

    @property
    def untouched(self) -> tuple[tuple[float, float], ...]:
        """The intervals of the parameter that the follower bridges without touching."""
        return self.pair.bridged

    @property
    def greatest_pressure_angle(self) -> float:
        """The greatest absolute pressure angle; NaN without any."""
        sizes = np.abs(self.pressure_angle)
        return float(np.nanmax(sizes)) if np.isfinite(sizes).any() else float("nan")

    @property
    def allowed_pressure_angle(self) -> float:
        """The customary limit of the pressure angle: 30 degrees for a translating follower, else 35."""
        return float(np.deg2rad(TRANSLATING if self.oscillates is False else OSCILLATING))

    @property
    def warnings(self) -> tuple[str, ...]:
        """The faults of the cam, a sentence each."""
        return tuple(self._warnings())

    def _warnings(self) -> Iterator[str]:
        from compoundkin.model.profiles.synthesised import Synthesised

        found, allowed = np.rad2deg(self.greatest_pressure_angle), np.rad2deg(self.allowed_pressure_angle)
        if found > allowed:
            yield f"The pressure angle reaches {found:.4g} degrees, more than the customary {allowed:.4g}."
        if self.undercut and not self.pair.is_flat:
            what = f"that the roller of radius {self.pair.roller:.6g} cannot enter"
            yield f"The profile has a hollow {what}, at {self._places(self.undercut)}."
        if self.untouched:
            yield f"The follower bridges a part of the profile, at {self._places(self.untouched)}."
        yield from self._running_off()
        made = self.pair.profile
        if isinstance(made, Synthesised) and not self.pair.is_flat and self.pair.roller != made.roller:
            yield (
                f"The profile is made for a roller of radius {made.roller:.6g}, not {self.pair.roller:.6g}: "
                "the follower does not follow its program."
            )

    def _running_off(self) -> Iterator[str]:
        curve = self.pair.curve
        if curve.closed or not np.isfinite(self.parameter).any():
            return
        room = LEFT * (curve.high - curve.low)
        if np.nanmin(self.parameter) < curve.low + room or np.nanmax(self.parameter) > curve.high - room:
            yield "The contact comes close to an end of the open profile."

    def _places(self, found: tuple[tuple[float, float], ...]) -> str:
        """Return intervals of the parameter as points of the profile."""
        points = [(complex(self.pair.curve.at(a).c[0]), complex(self.pair.curve.at(b).c[0])) for a, b in found]
        return ", ".join(f"{_point(a)} to {_point(b)}" for a, b in points)

    def __repr__(self) -> str:
        return f"CamAnalysis({self.pair.name!r}, follower {self.follower!r})"


@checked
def cam_analysis(motion: Motion, name: str) -> CamAnalysis:
    """Return the analysis of a cam or flat-faced cam pair over a motion.

    Raises UnknownName for an unknown pair, InvalidInput for a pair without a profile and a motion without velocities.

    Source: R. L. Norton, Cam Design and Manufacturing Handbook, 2nd ed., chapter 7.

    >>> import compoundkin as ck
    >>> eccentric = ck.Mechanism(
    ...     "Eccentric", ck.link("frame", A=0), ck.link("cam", A=0), ck.link("follower", P=0),
    ...     ck.slide("follower", on="frame", through="A", angle=ck.deg(90)),
    ...     ck.cam("follower", on="cam", profile=ck.profiles.disc(20, (10, 0)), radius=5), ck.drive("cam"))
    >>> found = cam_analysis(ck.solve(eccentric, {"cam": ck.deg([0, 90])}), "follower/cam")
    >>> np.rad2deg(found.pressure_angle).round(6).tolist()  # arcsin(10 / 25)
    [23.578178, 0.0]
    >>> found.radius_of_curvature.round(9).tolist()
    [20.0, 20.0]
    """
    pair = _pair_of(motion, name)
    ends, poses = motion.inputs.ends[name], tuple(motion.poses[member] for member in pair.members)
    touch = pair.touch(ends, poses)
    place, normal = touch.place.c[0], touch.normal.c[0]
    cam = motion.poses[pair.on]
    s = pair.parameter(ends, poses)
    with np.errstate(divide="ignore"):
        radius = 1.0 / (pair.outward * pair.curve.curvature(s))  # positive where convex toward the follower
    first, second = (velocity_at(motion.poses[member], place) for member in pair.members)
    follower, oscillates, _ = direction_of(motion, pair, place)
    return CamAnalysis(
        motion,
        pair,
        follower,
        oscillates,
        contact=motion.grid.known(place),
        contact_on_cam=motion.grid.known(np.conjugate(cam.u.c[0]) * (place - cam.z.c[0])),
        parameter=motion.grid.known(s),
        pressure_angle=pressure_angle(motion, name),
        radius_of_curvature=motion.grid.known(radius),
        pitch_radius=motion.grid.known(radius + ends[1].measure) if not pair.is_flat else None,
        sliding=motion.grid.known(dot(second - first, 1j * normal)),
    )


@checked
def cam_pairs(motion: Motion) -> tuple[str, ...]:
    """Return the names of the pairs that can be analysed, in order."""
    return tuple(pair.name for pair in motion.mechanism.written_pairs if as_profile_contact(pair))


def _pair_of(motion: Motion, name: str) -> ProfileContact:
    known = {pair.name: pair for pair in motion.structure.pairs}
    if name not in known:
        raise UnknownName(Problem(str(name), "there is no such pair", suggestion(str(name), list(cam_pairs(motion)))))
    pair = as_profile_contact(known[name])
    if pair is None:
        raise InvalidInput(
            Problem(name, f"a {known[name].title} has no profile", suggestion("", list(cam_pairs(motion))))
        )
    if motion.order < 1:
        raise InvalidInput(Problem(name, "the motion has no velocities", "solve(..., order=1) or more"))
    return pair


def _point(place: complex) -> str:
    return f"({place.real:.6g}, {place.imag:.6g})"
