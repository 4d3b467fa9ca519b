"""All configurations of any Assur group: every way in which its bodies can be assembled."""

from __future__ import annotations

from compoundkin.kinematics.assembly.all_configurations import all_configurations
from compoundkin.kinematics.assembly.elimination import exact_count
from compoundkin.kinematics.assembly.loop_closure import Connection, GroupGeometry, from_group
from compoundkin.kinematics.configuration import Configurations

__all__ = ["Configurations", "Connection", "GroupGeometry", "all_configurations", "exact_count", "from_group"]
