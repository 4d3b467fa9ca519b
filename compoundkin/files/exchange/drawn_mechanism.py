"""From a drawing to a mechanism."""

from __future__ import annotations

from compoundkin.files.exchange.drawing import Drawing
from compoundkin.files.exchange.exchanged import Imported


def mechanism_of(drawing: Drawing, form: str) -> Imported:
    """Return the mechanism that a drawing shows."""
    raise NotImplementedError
