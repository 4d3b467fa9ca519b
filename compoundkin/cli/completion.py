"""`compoundkin completion`: the script that completes commands in a shell."""

from __future__ import annotations

import click

from compoundkin.cli.shell import put

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
def command(shell: str) -> int:
    """Print the script that completes commands, options, files and catalog names in your shell."""
    from click.shell_completion import get_completion_class

    from compoundkin.cli import cli

    kind = get_completion_class(shell)
    if kind is None:  # pragma: no cover - click knows all three
        raise click.UsageError(f"{shell} is not supported")
    put(kind(cli, {}, "compoundkin", "_COMPOUNDKIN_COMPLETE").source() + "\n")
    return 0
