"""Mechanism files in and out, their schema (`json_schema`), and saving whatever can be saved (`saved_files`)."""

from __future__ import annotations

from compoundkin.files.mechanism_files import dumps, load, loads

__all__ = ["dumps", "load", "loads"]
