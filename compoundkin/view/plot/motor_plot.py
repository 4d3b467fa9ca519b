"""`motor_curves`: what a machine asks at the shaft of a motor over a motion, and the motor's torque over its speed."""

from __future__ import annotations

from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import trapezoid
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.dynamics.motor_sizing import RPM, SizedMotor, Sizing
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.canvas import PointLabel, value_text
from compoundkin.view.plot.plot_style import GREY, INK, Plot

# Inches.
SIZE = (7.0, 4.6)
# The curve of a motor is drawn at so many speeds.
DRAWN = 400
# What a motor gives is drawn up to so many times of what is asked or rated.
STRONG = 4.0
# Room above the highest curve, as a part of it.
ROOM = 1.12


@checked
def motor_curves(
    sized: Sizing,
    motor: str | None = None,
    *,
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw the torque over the speed at a motor's shaft through a motion, and what the motor gives there.

    The motor is one of the list by its name, else the smallest that does, or the one with the greatest reserve if none
    does; it is behind the gear of the sizing. Below the shaded line it runs for ever, below the curve for a while; both
    are drawn for either sense and for braking. The dot is the effective torque, which has to be in the shade, at the
    root mean square of the speed. `size` is in inches.

    Raises UnknownName for a motor that is not in the list.

    >>> from compoundkin.dynamics.force_analysis import force_analysis
    >>> from compoundkin.dynamics.motor_sizing import sizing
    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> sized = sizing(force_analysis(solve(load("shaper-cutting-force"))))
    >>> motor_curves(sized).figure.axes[0].get_ylabel()
    'torque at the shaft [N m]'
    """
    shown = _shown(sized, motor)
    own = shown.motor
    torques, speeds = sized.at_shaft(own, shown.gear)
    # a shaft that turns backward most of the time is seen from its other end
    torques, speeds = (one * (-1.0 if np.mean(speeds) < 0.0 else 1.0) for one in (torques, speeds))
    pace = np.concatenate([speeds, speeds[:1]]) / RPM if _is_cycle(sized) else speeds / RPM
    path = np.concatenate([torques, torques[:1]]) if _is_cycle(sized) else torques
    with plot_style.styled():
        why = "; ".join(shown.reasons) or f"it does: use {shown.use:.3g}, reserve {shown.reserve:.3g}"
        text = f"{own.name} drives {sized.driver} behind a gear of {shown.gear:.4g}\n{why}" if title is None else title
        figure, axes = canvas.panels(1, text, size or SIZE)
        one, blue = axes[0], plot_style.COLOURS[0]
        _draw_limits(one, shown, torques, speeds)
        one.plot(pace, path, color=blue, label="over the motion")
        canvas.draw_arrow(one, pace, path, blue)
        middle = float(np.sqrt(trapezoid(np.square(speeds), sized.times) / np.ptp(sized.times))) / RPM
        canvas.draw_dots(one, [middle], [shown.rms], plot_style.COLOURS[1], 6.0)
        said = f"effective {value_text(shown.rms)} N m, rated {value_text(own.rated)}"
        labels = [PointLabel(one, middle, shown.rms, said, 1j, plot_style.COLOURS[1])]
        one.axhline(0.0, color=GREY, linewidth=0.8, zorder=1)
        one.set_xlabel("speed [rpm]")
        one.set_ylabel("torque at the shaft [N m]")
        canvas.draw_legend(one)
        return canvas.finished(figure, labels)


def _shown(sized: Sizing, motor: str | None) -> SizedMotor:
    """Return the motor of a name, else the one to show."""
    if motor is not None:
        for one in sized.motors:
            if one.motor.name == motor:
                return one
        names = [one.motor.name for one in sized.motors]
        raise UnknownName(Problem("motor", f"there is no motor {motor!r} in the list", suggestion(motor, names)))
    if not sized.motors:
        raise InvalidInput(Problem("motors", "the list is empty", "give it motors"))
    return sized.chosen or max(sized.motors, key=lambda one: one.reserve)


def _is_cycle(sized: Sizing) -> bool:
    """Whether the motion ends as it begins."""
    ends = sized.torques[[0, -1]], sized.speeds[[0, -1]]
    return all(bool(np.ptp(one) <= 1e-6 * np.max(np.abs(one))) for one in ends)


def _draw_limits(axes: Any, shown: SizedMotor, torques: Any, speeds: Any) -> None:
    """Draw what the motor gives for ever and for a while, in the quadrants that the motion comes to."""
    own = shown.motor
    pace = np.linspace(0.0, own.top_speed, DRAWN)
    greatest, rated = own.greatest(pace), np.where(pace <= own.rated_speed, own.rated, np.nan)
    told = False
    for along in (1.0, -1.0):
        for up in (1.0, -1.0):
            if not np.any((along * speeds > 0.0) & (up * torques > 0.0)):
                continue
            x = along * pace / RPM
            words = {} if told else {"label": "greatest"}
            axes.plot(x, up * greatest, color=INK, linewidth=1.2, **words)
            fill = {} if told else {"label": "for ever"}
            axes.fill_between(x, 0.0, up * rated, color=plot_style.COLOURS[2], alpha=0.18, linewidth=0, **fill)
            told = True
    high = max(float(np.max(np.abs(torques))), own.rated)
    # a motor far too strong would make a line of the motion
    most = max(high, min(own.peak, STRONG * high)) * ROOM
    axes.set_ylim(-most if np.any(torques * np.sign(speeds) < 0.0) else 0.0, most)
