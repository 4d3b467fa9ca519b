"""`compoundkin schema`: the JSON Schema of mechanism files."""

from __future__ import annotations

import click

from compoundkin.cli.shell import put


@click.command(
    epilog="""\b
Example:
  compoundkin schema > mechanism.schema.json
"""
)
def command() -> int:
    """Print the JSON Schema of mechanism files. Editors check and complete TOML and JSON with it."""
    import json

    from compoundkin.files import schema

    put(json.dumps(schema(), indent=2, ensure_ascii=False) + "\n")
    return 0
