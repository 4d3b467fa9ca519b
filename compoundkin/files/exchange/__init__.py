"""Files of other programs, in and out: a folder for each format, drawings between them, and this registry."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from compoundkin.files.exchange.contract import ExchangeFormat

# Each format's word with its module, which has it as FORMAT and is imported when it is asked for. In the order in
# which they are tried on a content; those whose marks are plainest first.
MODULES = {
    "linkage": "linkage.linkage_format",
    "pyslvs": "pyslvs.pyslvs_format",
    "pyslvs-project": "pyslvs.pyslvs_project",
    "pmks-file": "pmks.pmks_file",
    "pylinkage": "pylinkage.pylinkage_format",
    "linkage-sim": "linkage_sim.linkage_sim_format",
    "pmks+": "pmks_plus.pmks_plus_format",
    "joints": "pmks.joint_table",
    "pmks": "pmks.pmks_format",
    "pmks-url": "pmks.pmks_url",
    "mjcf": "mjcf.mjcf_format",
    "geogebra": "geogebra.geogebra_format",
    "geogebra-commands": "geogebra.geogebra_commands",
    "dxf": "dxf.dxf_format",
    "cam-profile": "cam_profile.cam_profile_format",
}

# Formats that are only read, and those that are only written.
READ_ONLY = ("linkage-sim", "pmks-file")
WRITE_ONLY = ("mjcf", "geogebra", "geogebra-commands", "dxf", "cam-profile")


def format_named(name: str) -> ExchangeFormat:
    """Return the format of a word."""
    found: ExchangeFormat = import_module(f"{__name__}.{MODULES[name]}").FORMAT
    return found
