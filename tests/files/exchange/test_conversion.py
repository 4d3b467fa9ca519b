"""What holds for every format: what each is called, recognition, bounds, damaged files, and the way there and back."""

from __future__ import annotations

import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files.exchange import MODULES, READ_ONLY, WRITE_ONLY
from compoundkin.files.exchange.content import MOST_BYTES, Content
from compoundkin.files.exchange.known_formats import readable_formats, recognised, writable_formats
from tests import catalog
from tests.files.exchange.mutations import contents, failures, text_of

READ, WRITTEN = tuple(readable_formats()), tuple(writable_formats())
# Damaged files of each format: thousands by hand, python -m tests.files.exchange.mutations
DAMAGED = 60
BOTH = tuple(name for name in READ if name in WRITTEN)
# How far a mechanism may be from itself after a way there and back, as a part of its size: share links have 3 decimals.
ROUNDED = {"pmks+": 1e-4}


def test_the_registry_says_what_the_formats_are() -> None:
    known = {one.name: one for one in ck.exchange.formats()}
    assert list(known) == list(MODULES)
    for name, one in known.items():
        assert (one.is_read, one.is_written) == (name not in WRITE_ONLY, name not in READ_ONLY)
        assert one.title
        assert one.program


def test_formats_are_recognised_by_their_contents_whatever_the_file_is_called(tmp_path: Path) -> None:
    for form in READ:
        for text in contents(form):
            content = Content(text.encode("utf-8"), "a.txt")
            found = recognised(content, readable_formats())
            # samples of PMKS are texts and addresses
            assert found.program == readable_formats()[form].program, text[:200]
            assert found.name == form or {found.name, form} == {"pmks", "pmks-url"}, text[:200]
    path = tmp_path / "crank.linkage2"
    path.write_text(contents("pmks")[0])
    assert ck.exchange.read(path).form == "pmks"
    with pytest.raises(ck.errors.InvalidInput, match="it is a web page"):
        ck.exchange.read(f"<html><body>{contents('pmks')[0]}")
    with pytest.raises(ck.errors.InvalidInput, match=r"this is no Linkage .* but "):
        ck.exchange.read(path, "linkage")


def test_texts_are_read_as_windows_and_macs_write_them(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    for form in READ:
        text = contents(form)[0]
        meant = ck.exchange.read(text).mechanism
        ends = text.replace("\n", "\r"), text.replace("\n", "\r\n"), "\ufeff" + text
        for raw in (*(one.encode() for one in ends), text.encode("utf-16")):
            path.write_bytes(raw)
            assert ck.exchange.read(path).mechanism.replace(title=meant.title) == meant, form


@pytest.mark.parametrize("form", READ)
def test_damaged_files_are_read_or_refused_soon(form: str) -> None:
    found = list(failures(form, DAMAGED))
    assert not found, f"{found[0].told}\n{found[0].text!r}"


def test_what_is_too_large_is_refused_at_once(tmp_path: Path) -> None:
    large = tmp_path / "large"
    with large.open("wb") as file:
        file.truncate(100_000_000)
    link = "https://app.pmksplus.com/?" + "0" * 1_000_000
    for source in (large, link, "mech=" + "a" * 1_000_000, "M[" * 500_000, "0\n" * MOST_BYTES):
        for form in ("", READ[0]):
            begin = time.process_time()
            with pytest.raises(ck.errors.InvalidInput, match="bytes; a mechanism's has at most"):
                ck.exchange.read(source, form)
            assert time.process_time() - begin < 5.0


@pytest.mark.parametrize("form", READ)
def test_what_repeats_to_the_bound_is_answered_soon(form: str, tmp_path: Path) -> None:
    """The first kilobytes of a file, then one of its lines or a bracket without end."""
    text = contents(form)[0]
    half = len(text) // 2
    room = readable_formats()[form].most - len(text) - 1
    for piece in (text.splitlines()[len(text.splitlines()) // 2] + "\n", "[", "9"):
        large = text[:half] + piece * (room // len(piece)) + text[half:]
        begin = time.process_time()
        with suppress(ck.errors.CompoundkinError):  # lines without a word may repeat
            ck.exchange.read(large + "\n", form)
        assert time.process_time() - begin < 5.0, piece


@pytest.mark.parametrize("form", BOTH)
def test_there_and_back_it_is_the_same(form: str) -> None:
    for name in ("crank-rocker", "slider-crank-offset", "six-bar"):
        mechanism = catalog.mechanism(name)
        try:
            written = ck.exchange.write(mechanism, form)
        except ck.errors.InvalidInput:
            continue
        found = ck.exchange.compare(mechanism, ck.exchange.read(text_of(written) + "\n").mechanism)
        assert found.within(ROUNDED.get(form, 1e-9)), (name, found)
        assert found.largest is not None
        assert np.isfinite(found.largest.distance)
