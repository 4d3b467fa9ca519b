"""`compoundkin import`: a mechanism out of another program's file or link."""

from __future__ import annotations

from pathlib import Path

import click

from compoundkin.base.suffixes import alternatives, file_format
from compoundkin.cli.file_options import import_with_notes, to_file, write_new
from compoundkin.cli.shell import put, say


class WithFormats(click.Command):
    """A command that lists the formats of other programs in its help."""

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the formats that are read, then the examples."""
        from compoundkin.files.exchange.known_formats import readable_formats

        rows = [(one.name, one.title) for one in readable_formats().values()]
        with formatter.section("Formats that are read"):
            formatter.write_dl(rows)
        super().format_epilog(ctx, formatter)


@click.command(
    cls=WithFormats,
    epilog="""\b
Examples:
  compoundkin import crane.linkage2 -o crane.toml
  compoundkin import 'https://app.pmksplus.com/?...' -o mine.toml
  compoundkin import joints.csv --form joints
  xclip -o | compoundkin import - -o pasted.toml
""",
)
@click.argument("source", metavar="FILE|LINK")
@click.option("--form", "form", default="", metavar="FORMAT", help="Its format; it is recognised if left out.")
@to_file(f"Write a mechanism file here: {alternatives('mechanism')}; else TOML to stdout.")
@click.option("--force", is_flag=True, help="Replace a file that is there.")
def command(source: str, form: str, path: str | None, force: bool) -> int:
    """Read a mechanism from another program's file, or from a link that holds it. Nothing is fetched.

    What is not converted is noted on stderr. - reads standard input.
    """
    from compoundkin.files.mechanism_files import encoded

    syntax = "toml" if path is None else file_format("mechanism", path)
    found = import_with_notes(source, form)
    content = encoded(found.mechanism, syntax, path or source)
    if path is None:
        put(content)
    else:
        write_new(Path(path), content, force)
        say(f"Wrote {path}; see it with: compoundkin report {path}")
    return 0
