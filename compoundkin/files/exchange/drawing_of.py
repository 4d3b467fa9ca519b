"""From a mechanism at one pose to a drawing."""

from __future__ import annotations

from compoundkin.files.exchange.drawing import Drawing
from compoundkin.files.exchange.shown_mechanism import ShownMechanism


def drawing_of(shown: ShownMechanism) -> Drawing:
    """Return a drawing of a mechanism. Raises InvalidInput listing all that no drawing can say."""
    raise NotImplementedError
