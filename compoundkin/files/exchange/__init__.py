"""Files of other programs, in and out: a folder for each format, drawings between them, and this registry."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from compoundkin.files.exchange.contract import ExchangeFormat

# Each format's word with its module, imported on demand, and its name there, else FORMAT. In the order in
# which they are tried on a content; those whose marks are plainest first.
MODULES = {
    "linkage": "linkage.linkage_format",
    "pyslvs": "pyslvs_format",
    "pyslvs-project": "pyslvs_format:PROJECT",
    "pmks-file": "pmks_format:FILE",
    "pylinkage": "pylinkage_format",
    "linkage-sim": "linkage_sim",
    "pmks+": "pmks_plus_format",
    "joints": "joint_table",
    "pmks": "pmks_format",
    "pmks-url": "pmks_format:URL",
    "mjcf": "mjcf.mjcf_format",
    "geogebra": "geogebra.geogebra_format",
    "geogebra-commands": "geogebra.geogebra_format:COMMANDS",
    "dxf": "dxf.dxf_format",
    "cam-profile": "cam_profile",
}

# Formats that are only read, and those that are only written.
READ_ONLY = ("linkage-sim", "pmks-file")
WRITE_ONLY = ("mjcf", "geogebra-commands", "dxf", "cam-profile")


def format_named(name: str) -> ExchangeFormat:
    """Return the format of a word."""
    module, _, constant = MODULES[name].partition(":")
    format_: ExchangeFormat = getattr(import_module(f"{__name__}.{module}"), constant or "FORMAT")
    return format_
