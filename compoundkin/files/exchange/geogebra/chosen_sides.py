"""Which of its two ways each dyad stands over the whole range, and angles with their full turns."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.files.exchange.geogebra.dragged_construction import Construction
from compoundkin.files.exchange.geogebra.polar_sums import Angle, named, number
from compoundkin.kinematics import Motion


class ChosenSides:
    """The signs and turns that a motion shows at its assembled poses."""

    def __init__(self, build: Construction, motion: Motion, sliders: Mapping[str, str]) -> None:
        self._build, self._motion, self._sliders = build, motion, sliders
        self._known = np.flatnonzero(np.ravel(motion.failed) == 0)
        self._counted: dict[str, Angle] = {}
        self._whole = set(sliders.values())

    def is_told(self, k: int) -> bool:
        """Return whether a group has one sign, or one that a single driver tells."""
        return len(set(self._signs(k).tolist())) < 2 or (self._moving is not None and self._turns_once(k))

    def mode(self, k: int, index: str) -> str:
        """Add the number that says which way a group stands; return its name."""
        signs = self._signs(k)
        caption = f"mode of the group of {index}: 1 or -1"
        if len(set(signs.tolist())) < 2:
            return self._build.dimension("m", index, float(signs[0]), caption)
        places = self._values[np.argsort(self._values)]
        ordered = signs[np.argsort(self._values)]
        text = number(ordered[-1])
        for j in reversed(range(len(ordered) - 1)):
            if ordered[j] != ordered[j + 1]:
                between = self._between(k, places[j], places[j + 1])
                if not places[0] < between < places[-1]:  # at the very end of the range both are the same
                    continue
                text = f"If({self._moving} < {number(between)}, {number(ordered[j])}, {text})"
        return self._build.helper("m", index, text, caption)

    def _between(self, k: int, low: float, high: float) -> float:
        """Return where a group changes over between two values of the driver."""
        s = np.ravel(self._motion.change_points[k])
        row = np.interp(s[np.isfinite(s)], self._known, self._values)
        inside = row[(row >= low) & (row <= high)]
        near = float(np.round(inside[0], 9)) if len(inside) else (low + high) / 2.0
        return near

    def _turns_once(self, k: int) -> bool:
        """Whether equal values of the driver go with equal signs: the motion does not come back otherwise."""
        order = np.argsort(self._values, kind="stable")
        same = np.diff(self._values[order]) == 0.0
        return not bool(np.any(same & (np.diff(self._signs(k)[order]) != 0.0)))

    def _signs(self, k: int) -> Number:
        found = self._motion.tracker.sign(k, np.array([[0]]), self._known[None].astype(float))
        return np.broadcast_to(np.ravel(found), self._known.shape)

    @property
    def _moving(self) -> str | None:
        """The slider of the only driver that moves."""
        moving = [name for name, values in self._driven.items() if np.ptp(values) > 0.0]
        return self._sliders[moving[0]] if len(moving) == 1 else None

    @property
    def _values(self) -> Number:
        """The values of that driver, in degrees or lengths."""
        return next(values for values in self._driven.values() if np.ptp(values) > 0.0)

    @property
    def _driven(self) -> dict[str, Number]:
        angles = self._motion.structure.driven_angles
        rows = {name: np.ravel(drive.value) for name, drive in self._motion.drives.items()}
        found = {
            name: row[self._known] if row.size > 1 else np.repeat(row, len(self._known)) for name, row in rows.items()
        }
        return {name: np.rad2deg(row) if angles[name] else row for name, row in found.items()}

    def counted(self, link: str, angle: Angle) -> Angle:
        """Return the angle of a link with full turns counted; `angle` lacks these."""
        if self._is_counted(angle):
            return angle
        if link not in self._counted:
            per, middle = self._course(link) or (0.0, 0.0)
            off = angle.minus(Angle(rest=middle)).text + (f" - {number(per)} * {self._moving}" if per else "")
            text = f"{angle.text} - 360 * floor(({off}) / 360 + 0.5)"
            self._counted[link] = named(self._build.helper("τ", link, text, f"angle of {link} with full turns"))
            self.note_counted(self._counted[link])
        return self._counted[link]

    def can_count(self, link: str) -> bool:
        """Return whether a link keeps within a turn of some multiple of the driver."""
        return self._course(link) is not None

    def note_counted(self, angle: Angle) -> None:
        """Note that an angle has its full turns."""
        self._whole.update(name for _, name in angle.names)

    def _is_counted(self, angle: Angle) -> bool:
        return {name for _, name in angle.names} <= self._whole

    def _course(self, link: str) -> tuple[float, float] | None:
        """Return how many turns a link makes for one of the driver, and the middle of what is left."""
        theta = np.rad2deg(np.ravel(self._motion.poses[link].angle.c[0]))
        theta = theta[self._known] if theta.size > 1 else np.repeat(theta, len(self._known))
        for per in (0.0, 1.0, -1.0, 2.0, -2.0) if self._moving else (0.0,):
            left = theta - (per * self._values if per else 0.0)
            if np.ptp(left) < 350.0:
                return per, float(np.round((left.min() + left.max()) / 2.0))
        return None


def steps_of(values: Number) -> float:
    """Return a step for a slider, a plain part of its range."""
    span = float(np.ptp(values))
    power = 10.0 ** np.floor(np.log10(span / 200.0))
    return float(next(factor * power for factor in (1, 2, 5, 10) if factor * power >= span / 500.0))
