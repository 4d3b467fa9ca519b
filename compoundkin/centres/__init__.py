"""Instant centres by the theorem of Aronhold and Kennedy, and the independent routes that confirm them."""

from __future__ import annotations

from compoundkin.centres.model import Centre, Centres, Status
from compoundkin.centres.solving import instant_centres
from compoundkin.centres.steps import Step

__all__ = ["Centre", "Centres", "Status", "Step", "instant_centres"]
