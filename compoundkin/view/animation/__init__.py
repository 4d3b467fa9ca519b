"""Animations of motions: GIF, MP4, and SVG that moves by itself."""

from __future__ import annotations

from compoundkin.view.animation.animation import Animation
from compoundkin.view.animation.motion_animation import animate

__all__ = ["Animation", "animate"]
