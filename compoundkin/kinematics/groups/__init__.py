"""The kinds of Assur group: one file each, and this registry; any other group goes to `general`."""

from __future__ import annotations

from compoundkin.kinematics.groups.contract import Attachment, Closed, Dyad
from compoundkin.kinematics.groups.prp import PRP
from compoundkin.kinematics.groups.rpp import RPP
from compoundkin.kinematics.groups.rpr import RPR
from compoundkin.kinematics.groups.rrp import RRP
from compoundkin.kinematics.groups.rrr import RRR

DYADS: dict[str, type[Dyad]] = {kind.name: kind for kind in (RRR, RRP, RPR, PRP, RPP)}

__all__ = ["DYADS", "Attachment", "Closed", "Dyad"]
