"""The verbs `compare` and `import`, and other programs' files wherever a file is taken."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner, Result

import compoundkin as ck
from compoundkin.cli import cli
from tests.files.exchange.references import entry


def run(*args: str, stdin: bytes | None = None) -> Result:
    return CliRunner().invoke(cli, list(args), input=stdin, catch_exceptions=False)


@pytest.fixture
def linkage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A file of Linkage in the folder where the commands run."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bar.linkage2").write_text(entry("linkage_four_bar")["text"], encoding="utf-8")
    return "bar.linkage2"


def test_a_file_is_imported_and_is_the_same(linkage: str) -> None:
    told = run("import", linkage, "-o", "mine.toml")
    assert (told.exit_code, told.stdout) == (0, "")
    assert "Wrote mine.toml; see it with: compoundkin report mine.toml" in told.stderr
    assert "mobility 1, groups RRR" in told.stderr
    assert ck.load("mine.toml").title == ck.exchange.read(Path(linkage)).mechanism.title
    # to stdout, from a pipe and by its form it is the same file
    written = Path("mine.toml").read_bytes()
    assert run("import", linkage).stdout_bytes == written
    piped = run("import", "-", "--form", "linkage", stdin=Path(linkage).read_bytes())
    assert piped.stdout_bytes.partition(b"\n[")[2] == written.partition(b"\n[")[2]
    same = run("compare", "mine.toml", linkage, "--tolerance", "1e-12")
    assert same.exit_code == 0
    assert "they move alike to rounding" in same.stdout
    assert run("solve", linkage, "--at", "0").stdout.count("\n") == 2


def test_links_stand_for_files_in_every_spelling() -> None:
    link = ck.exchange.write(ck.load("jansen-leg"), "pmks+").text.strip()
    bare = link.partition("?")[2]
    assert len(bare) > 255  # than which no file has a longer name
    told = [run("structure", spelt) for spelt in (link, link.removeprefix("https://"), bare)]
    assert [one.exit_code for one in told] == [0, 0, 0]
    assert told[0].stdout == told[1].stdout == told[2].stdout
    assert "pmks_mechanism: one pose" in run("export", bare, "--to", "python").stdout


def test_nothing_is_replaced_unless_forced(linkage: str) -> None:
    Path("mine.toml").write_text("mine")
    refused = run("import", linkage, "-o", "mine.toml")
    assert (refused.exit_code, Path("mine.toml").read_text()) == (2, "mine")
    assert "--force" in refused.stderr
    assert run("import", linkage, "-o", "mine.toml", "--force").exit_code == 0
    assert ck.load("mine.toml").links


def test_what_differs_has_its_own_exit_code(tmp_path: Path) -> None:
    mechanism = ck.load("crank-rocker")
    longer = 1.0001 * complex(mechanism.geometry.points["crank"]["B"])
    ck.save(mechanism.replace(ck.link("crank", A=0, B=longer)), tmp_path / "longer.toml")
    other = str(tmp_path / "longer.toml")
    assert run("compare", "crank-rocker", other, "--tolerance", "1e-2").exit_code == 0
    told = run("compare", "crank-rocker", other, "--tolerance", "1e-7", "--format", "json")
    assert told.exit_code == 4
    assert "not the same to 1e-07 of the size" in told.stderr
    assert run("compare", "crank-rocker", "six-bar").exit_code == 4


@pytest.mark.parametrize(("args", "told"), [
    (["import", "no-such.linkage2"], "there is no such file"),
    (["import", "."], "this is a folder"),
    (["compare", "six-bar", "six-bar", "--tolerance", "nan"], "nan is no number"),
    (["import", "https://example.org/a.html"], "nothing is fetched"),
    (["import", "bar.linkage2", "--form", "linkge"], "did you mean 'linkage'?"),
    (["import", "bar.linkage2", "-o", "a.xml"], "a mechanism is not saved as '.xml'"),
    (["import", "own.toml"], "a mechanism file of compoundkin"),
    (["import", "a.bin"], "binary"),
    (["report", "a.bin"], "binary"),
    (["structure", 5000 * "x"], "neither a file nor in the catalog"),
    (["import", "empty"], "it is empty"),
    (["export", "six-bar", "-o", "a.zzz"], "nothing is exported as '.zzz'"),
    (["export", "six-bar", "--to", "linkage", "--free", "crank.D"], "does not go with --to linkage"),
    (["export", "six-bar", "--to", "c", "--at", "3"], "does not go with --to c"),
    (["export", "six-bar", "--to", "tikz", "--option", "a=1"], "does not go with --to tikz"),
])  # fmt: skip
def test_what_is_wrong_is_told(args: list[str], told: str, linkage: str) -> None:
    assert run("catalog", "copy", "six-bar", "own.toml").exit_code == 0
    Path("a.bin").write_bytes(b"\x07\0\1")
    Path("empty").write_bytes(b"")
    before = set(Path().iterdir())
    result = run(*args)
    assert (result.exit_code, result.stdout) == (2, "")
    assert told in " ".join(result.stderr.split())
    assert set(Path().iterdir()) == before


def test_the_formats_stand_in_the_helps() -> None:
    read, written = run("import", "--help").stdout, run("export", "--help").stdout
    for one in ck.exchange.formats():
        assert not one.is_read or one.name in read
        assert not one.is_written or one.name in written
    assert run("export", "six-bar", "--to", "tikz", "--at", "35").stdout.startswith("%")
