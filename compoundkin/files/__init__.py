"""Mechanism files in and out, their schema, and saving whatever can be saved."""

from __future__ import annotations

from compoundkin.files.json_schema import schema
from compoundkin.files.mechanism_files import dumps, load, loads
from compoundkin.files.saved_files import save

__all__ = ["dumps", "load", "loads", "save", "schema"]
