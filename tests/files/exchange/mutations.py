"""Damaged files of other programs: whatever stands in one, the answer is a mechanism or an error of the package, soon.

python -m tests.files.exchange.mutations --count 5000 [--form linkage]
"""

from __future__ import annotations

import argparse
import random
import re
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np

import compoundkin as ck
from compoundkin.files.exchange.content import Content
from compoundkin.files.exchange.geogebra.read_construction import unpacked
from compoundkin.files.exchange.known_formats import readable_formats
from tests import catalog
from tests.files.exchange.references import entries

# Mechanisms that are written to have more to damage, as far as a format has words for them.
WRITTEN = ("six-bar", "slider-crank", "planetary-train", "oscillating-cylinder", "scotch-yoke")
# What the samples call formats that have other words here.
SAMPLES = {
    **{"linkage": "linkage2", "pmks-file": "pmks-json", "pyslvs-project": "pyslvs-yaml"},
    **{"linkage-sim": "linkage-sim-json", "pylinkage": "pylinkage-json"},
}
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
NUMBERS = (
    "nan",
    "NaN",
    "inf",
    "-1e999",
    "1e308",
    "-1e-320",
    "0",
    "-0",
    "9" * 400,
    "1_0",
    "١",
    "0x10",
    "1e5",
    "",
    "1.5.2",
)
PIECES = (
    *("\0", "\n", "\r", "\ufeff", "\u2028", "é", "😀", '"', "'", "<", ">", "&amp;", "&x;", "<!DOCTYPE a>", "[", "]"),
    *("{", "}", ",", ".", ";", "|", "=", "!!python/object", "*a", "&a", "-", "0", "R", "P", "RP", "G", "ground", "  "),
    *("\t", "#", "\\u0000", "null", "true", "1e400"),
)
# An answer may take so long, on a core that others use too.
SECONDS = 5.0
# More pairs than these are not taken apart: two hundred slides side by side take half a minute, of whatever file.
MANY = 40
# Damage of a file is of one to so many kinds, one after another.
WORST = 3


# How many damaged contents were read as mechanisms.
READ: Counter[str] = Counter()


@dataclass(frozen=True)
class Failure:
    """What a damaged content did that none may do."""

    form: str
    text: str
    told: str


def text_of(written: ck.exchange.Exported) -> str:
    """The text of a file, that in the archive where it is one."""
    return unpacked(Content(written.content))


@cache
def contents(form: str) -> tuple[str, ...]:
    """Whole files of a format: the samples, and mechanisms of the catalog."""
    found = [one["text"] for word in (form, SAMPLES.get(form, form)) for one in entries(word)]
    written = {one.name for one in ck.exchange.formats() if one.is_written}
    for name in WRITTEN if form in written else ():
        try:
            found.append(text_of(ck.exchange.write(catalog.mechanism(name), form)))
        except ck.errors.CompoundkinError:
            continue
    assert found, form
    return tuple(found)


def damaged(rng: random.Random, text: str, others: tuple[str, ...]) -> str:
    """The text with some damage."""
    for _ in range(rng.randint(1, WORST)):
        text = rng.choice((_piece, _number, _cut, _without, _twice, _moved, _mixed, _letter))(rng, text, others)
    return text


def _piece(rng: random.Random, text: str, _: tuple[str, ...]) -> str:
    at = rng.randint(0, len(text))
    return text[:at] + rng.choice(PIECES) * rng.choice((1, 1, 1, 2, 50)) + text[at:]


def _number(rng: random.Random, text: str, _: tuple[str, ...]) -> str:
    found = list(NUMBER.finditer(text))
    if not found:
        return text
    one = rng.choice(found)
    new = rng.choice((*NUMBERS, rng.choice(found)[0], str(-float(one[0])), str(float(one[0]) * 1.001)))
    return text[: one.start()] + new + text[one.end() :]


def _cut(rng: random.Random, text: str, _: tuple[str, ...]) -> str:
    return text[: rng.randint(0, len(text))]


def _span(rng: random.Random, text: str) -> tuple[int, int]:
    """A stretch: of some letters, or whole lines."""
    begin = rng.randint(0, len(text))
    if rng.random() < 0.5:
        begin = text.rfind("\n", 0, begin) + 1
        end = text.find("\n", begin) + 1
        return begin, end or len(text)
    return begin, min(len(text), begin + rng.choice((1, 2, 5, 20, 100)))


def _without(rng: random.Random, text: str, _: tuple[str, ...]) -> str:
    begin, end = _span(rng, text)
    return text[:begin] + text[end:]


def _twice(rng: random.Random, text: str, _: tuple[str, ...]) -> str:
    begin, end = _span(rng, text)
    return text[:end] + text[begin:end] * rng.choice((1, 1, 3, 200)) + text[end:]


def _moved(rng: random.Random, text: str, _: tuple[str, ...]) -> str:
    begin, end = _span(rng, text)
    rest = text[:begin] + text[end:]
    at = rng.randint(0, len(rest))
    return rest[:at] + text[begin:end] + rest[at:]


def _mixed(rng: random.Random, text: str, others: tuple[str, ...]) -> str:
    other = rng.choice(others)
    return text[: rng.randint(0, len(text))] + other[rng.randint(0, len(other)) :]


def _letter(rng: random.Random, text: str, _: tuple[str, ...]) -> str:
    if not text:
        return text
    at = rng.randrange(len(text))
    return (
        text[:at] + chr(rng.choice((rng.randint(32, 126), ord(text[at]) ^ (1 << rng.randint(0, 6))))) + text[at + 1 :]
    )


def failures(form: str, count: int, seed: int = 0) -> Iterator[Failure]:
    """Damage files of a format so many times, and yield what went wrong."""
    rng = random.Random(f"{form} {seed}")
    known = contents(form)
    for _ in range(count):
        text = damaged(rng, rng.choice(known), known)
        told = tried(form, text)
        if told:
            yield Failure(form, text, told)


def tried(form: str, text: str) -> str:
    """What goes wrong with a text, or nothing: an error of another kind, one without words, a number that is none."""
    begin = time.process_time()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = ck.exchange.read(text + "\n", form)
            READ[form] += 1
            told = _unsound(found.mechanism)
    except ck.errors.CompoundkinError as error:
        told = "" if error.problems and all(one.what for one in error.problems) else "an error without words"
    except Exception:
        told = traceback.format_exc()
    took = time.process_time() - begin
    return told or (f"{took:.1f} s" if took > SECONDS else "")


def _unsound(mechanism: ck.Mechanism) -> str:
    """What is wrong with a mechanism that was read: it has numbers that are none, or cannot be written and read."""
    if len(mechanism.pins) + len(mechanism.written_pairs) < MANY:
        ck.decompose(mechanism)
    places = [p for own in mechanism.geometry.points.values() for p in own.values()]
    if not np.isfinite(np.array(places, dtype=complex)).all():
        return "places that are no numbers"
    return ""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=5000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--form", action="append")
    asked = parser.parse_args()
    for form in asked.form or readable_formats():
        begin = time.process_time()
        found = list(failures(form, asked.count, asked.seed))
        took = time.process_time() - begin
        print(f"{form}: {len(found)} of {asked.count} fail, {READ[form]} are read, {took:.0f} s", flush=True)
        seen = set()
        for one in found:
            last = one.told.strip().splitlines()[-1]
            if last not in seen:
                seen.add(last)
                print(repr(one.text[:3000]), one.told, sep="\n", flush=True)


if __name__ == "__main__":
    main()
