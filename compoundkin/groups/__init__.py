"""The kinds of Assur group: one file each, and this registry; any other group goes to `general`."""

from __future__ import annotations

from compoundkin.groups.contract import Attachment, Closed, Dyad
from compoundkin.groups.prp import PRP
from compoundkin.groups.rpp import RPP
from compoundkin.groups.rpr import RPR
from compoundkin.groups.rrp import RRP
from compoundkin.groups.rrr import RRR

DYADS: dict[str, type[Dyad]] = {kind.name: kind for kind in (RRR, RRP, RPR, PRP, RPP)}

__all__ = ["DYADS", "Attachment", "Closed", "Dyad"]
