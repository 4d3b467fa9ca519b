"""Linkages from their lengths, as ordinary mechanisms in a drawn pose.

Lengths are in one unit, angles in radians; which of two ways to assemble links is "open" or "crossed". The same words
are those of `compoundkin new` and of specifications such as "four-bar:60,20,50,40" on the command line.

>>> import compoundkin as ck
>>> crank_rocker = ck.linkages.four_bar(ground=60, crank=20, coupler=50, rocker=40)
>>> motion = ck.solve(crank_rocker, {"crank": ck.deg(60)}, speed=10)
>>> round(float(motion.links["rocker"].angular_velocity), 6)                                           # rad/s
2.915958
"""

from __future__ import annotations

from compoundkin.synthesis.four_bars import four_bar, inverted_slider_crank, quick_return, slider_crank
from compoundkin.synthesis.linkages import (
    cam_follower,
    five_bar,
    geared_five_bar,
    geneva,
    planetary,
    scissor,
    scotch_yoke,
    toggle,
)
from compoundkin.synthesis.six_bars import six_bar

__all__ = [
    "cam_follower",
    "five_bar",
    "four_bar",
    "geared_five_bar",
    "geneva",
    "inverted_slider_crank",
    "planetary",
    "quick_return",
    "scissor",
    "scotch_yoke",
    "six_bar",
    "slider_crank",
    "toggle",
]
