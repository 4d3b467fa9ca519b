"""Instant centres by the theorem of Aronhold and Kennedy."""

from __future__ import annotations

from compoundkin.analysis.centres.derivation import DerivationStep
from compoundkin.analysis.centres.instant_centres import Centre, Centres, Status, instant_centres

__all__ = ["Centre", "Centres", "DerivationStep", "Status", "instant_centres"]
