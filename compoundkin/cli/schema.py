"""`compoundkin schema`: the JSON Schema of mechanism files, and of study files."""

from __future__ import annotations

import click

from compoundkin.cli.shell import put

KINDS = ("mechanism", "study")


@click.command(
    epilog="""\b
Examples:
  compoundkin schema > mechanism.schema.json
  compoundkin schema study > study.schema.json
"""
)
@click.argument("kind", type=click.Choice(KINDS), default=KINDS[0])
def command(kind: str) -> int:
    """Print the JSON Schema of mechanism or study files. Editors check and complete TOML and JSON with it."""
    import json

    from compoundkin.files import schema
    from compoundkin.studies.study_document import study_schema

    result = {"mechanism": schema, "study": study_schema}[kind]()
    put(json.dumps(result, indent=2, ensure_ascii=False) + "\n")
    return 0
