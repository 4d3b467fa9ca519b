"""All configurations of any Assur group: every way in which its bodies can be assembled."""

from __future__ import annotations

from compoundkin.assembly.assembly import Assembly, Connection
from compoundkin.assembly.converting import from_group
from compoundkin.assembly.counting import exact_count
from compoundkin.assembly.solving import Configurations, all_configurations

__all__ = ["Assembly", "Configurations", "Connection", "all_configurations", "exact_count", "from_group"]
