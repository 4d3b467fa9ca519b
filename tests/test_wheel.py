"""The wheel works where no checkout is: it holds the catalog, the types marker and the command."""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

import compoundkin as ck

pytestmark = pytest.mark.full

ROOT = Path(__file__).parent.parent


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation"]
    subprocess.run([*build, "--wheel-dir", str(folder), str(ROOT)], check=True, capture_output=True, text=True)
    (wheel,) = folder.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder / "site")
    return folder / "site"


def run(site, *command):
    environment = {**os.environ, "PYTHONPATH": str(site)}
    return subprocess.run(
        [sys.executable, *command], cwd=site.parent, env=environment, capture_output=True, text=True, check=True
    )


def test_it_holds_all_of_the_catalog_and_the_types_marker(unpacked):
    shipped = {path.name for path in (unpacked / "compoundkin" / "_catalog").glob("*.toml")}
    assert shipped == {path.name for path in (ROOT / "catalog").glob("*.toml")}
    assert (unpacked / "compoundkin" / "py.typed").is_file()


def test_its_version_is_that_of_the_package(unpacked):
    assert [path.name for path in unpacked.glob("*.dist-info")] == [f"compoundkin-{ck.__version__}.dist-info"]


def test_it_holds_what_pages_are_made_with(unpacked):
    for room in ("view/page", "studio"):
        assets = ROOT / "compoundkin" / room / "assets"
        held = {path.relative_to(assets) for path in assets.rglob("*") if path.is_file()}
        assert held
        there = unpacked / "compoundkin" / room / "assets"
        assert {path.relative_to(there) for path in there.rglob("*") if path.is_file()} == held
    page = run(unpacked, "-m", "compoundkin", "report", "crank-rocker", "--format", "html").stdout
    assert page.startswith("<!DOCTYPE html>")


def test_it_holds_the_list_of_kinematic_chains(unpacked):
    code = (
        "import compoundkin.synthesis.chains as c; print(c.__file__, len(c.chains(10)), c.number_of(c.chains(10)[136]))"
    )
    where, *numbers = run(unpacked, "-c", code).stdout.split()
    assert Path(where).is_relative_to(unpacked)
    assert numbers == ["230", "137"]


def test_its_command_reports_a_shipped_mechanism(unpacked):
    where = run(unpacked, "-c", "import compoundkin; print(compoundkin.__file__)").stdout.strip()
    assert Path(where).is_relative_to(unpacked)
    assert "Six-bar of Example 3-4" in run(unpacked, "-m", "compoundkin", "report", "six-bar").stdout
