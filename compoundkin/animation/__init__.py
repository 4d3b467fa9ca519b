"""Animations of motions: GIF, MP4, and SVG that moves by itself."""

from __future__ import annotations

from compoundkin.animation.animating import animate
from compoundkin.animation.model import Animation

__all__ = ["Animation", "animate"]
