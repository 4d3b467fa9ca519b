"""Animations of motions: GIF, MP4, and SVG that moves by itself.

Frames are the same parts moved; Cairo draws them without packing them as PNG, which would take longer than drawing. In
SVG a part turns about that point of its link which moves least, so that a crank has two keyframes.
"""

from __future__ import annotations

from compoundkin.view.animation.animation import Animation, animate

__all__ = ["Animation", "animate"]
