"""`compoundkin schema`, `compoundkin completion`: the JSON Schema of files; the script that completes commands."""

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


SHELLS = ("bash", "zsh", "fish")


@click.command(
    epilog="""\b
Examples:
  eval "$(compoundkin completion bash)"      in ~/.bashrc
  eval "$(compoundkin completion zsh)"       in ~/.zshrc
  compoundkin completion fish > ~/.config/fish/completions/compoundkin.fish
"""
)
@click.argument("shell", type=click.Choice(SHELLS))
def completion_command(shell: str) -> int:
    """Print the script that completes commands, options, files and catalog names in your shell."""
    from click.shell_completion import get_completion_class

    from compoundkin.cli import cli

    kind = get_completion_class(shell)
    if kind is None:  # pragma: no cover - click knows all three
        raise click.UsageError(f"{shell} is not supported")
    put(kind(cli, {}, "compoundkin", "_COMPOUNDKIN_COMPLETE").source() + "\n")
    return 0
