"""Outlines of links as they are written: bars of a width, discs, polygons, pins, each on its layers."""

from __future__ import annotations

from compoundkin.model.outlines.link_outline import LinkOutline, outline

__all__ = ["LinkOutline", "outline"]
