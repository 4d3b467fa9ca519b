"""Animations of motions: GIF, MP4, and SVG that moves by itself."""

from __future__ import annotations

from compoundkin.view.animation.animation import Animation, animate

__all__ = ["Animation", "animate"]
