"""All configurations of any Assur group: every way in which its bodies can be assembled."""

from __future__ import annotations

from compoundkin.configurations.assembly import Assembly, Connection
from compoundkin.configurations.converting import from_group
from compoundkin.configurations.counting import exact_count
from compoundkin.configurations.solving import Configurations, all_configurations

__all__ = ["Assembly", "Configurations", "Connection", "all_configurations", "exact_count", "from_group"]
