"""Mechanism files in and out, their schema, and tables of a motion."""

from __future__ import annotations

from compoundkin.files.json_schema import schema
from compoundkin.files.mechanism_files import dumps, load, loads, save
from compoundkin.files.motion_tables import columns, save_table, to_pandas

__all__ = ["columns", "dumps", "load", "loads", "save", "save_table", "schema", "to_pandas"]
