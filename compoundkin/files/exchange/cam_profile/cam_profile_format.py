"""`cam-profile`: the profile of a cam or curved slot as a table of points, with pitch curve and cutter path."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any, ClassVar

from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.base.suffixes import suffix_for
from compoundkin.files.exchange.cam_profile.profile_points import ProfilePoints, profile_points
from compoundkin.files.exchange.contract import Writable
from compoundkin.files.exchange.exchanged import Exported
from compoundkin.files.exchange.option_values import positive, whole
from compoundkin.files.exchange.shown_mechanism import ShownMechanism
from compoundkin.model.pairs.profile_contact import ProfileContact, as_profile_contact

# How far chords may be off where it is not said, in parts of the profile's size.
CHORD = 1e-5
# No machine is finer than this part of the profile's size.
FINEST = 1e-8
FEWEST, MOST = 8, 1_000_000


class CamProfileFormat(Writable):
    """Points of a profile as CSV, a row for each."""

    name: ClassVar[str] = "cam-profile"
    program: ClassVar[str] = "milling and eroding machines"
    title: ClassVar[str] = "cam profile"
    suffix: ClassVar[str] = suffix_for("table", "csv")
    options: ClassVar[Mapping[str, str]] = MappingProxyType(
        {
            "cam": "the pair whose profile it is, where there are several",
            "tolerance": "how far chords may be off, a length; 1/100000 of the profile's size if left out",
            "points": "instead of a tolerance so many points at equal steps, of the cam's angle where made for one",
            "cutter": "the radius of a cutter, whose path is added",
        }
    )

    def write(self, shown: ShownMechanism, **options: Any) -> Exported:
        """Return the table. Raises InvalidInput or UnknownName where it is not said of which cam."""
        pair = _pair(shown, options.get("cam"))
        tolerance = positive("tolerance", options.get("tolerance"), CHORD * pair.extent, FINEST * pair.extent)
        cutter = None if options.get("cutter") is None else positive("cutter", options["cutter"], 0.0)
        found = profile_points(pair, tolerance, cutter, _count(options))
        unit = shown.mechanism.unit
        text = io.StringIO()
        rows = csv.writer(text, lineterminator="\n")
        rows.writerow(_heads(found, unit))
        rows.writerows(_rows(found))
        return Exported(text.getvalue().encode("utf-8"), self.name, tuple(_notes(pair, found, unit)))


def _pair(shown: ShownMechanism, name: Any) -> ProfileContact:
    """The pair that is asked for, or the only one."""
    known = {pair.name: found for pair in shown.pairs if (found := as_profile_contact(pair)) is not None}
    if not known:
        raise InvalidInput(Problem(shown.mechanism.title, "it has no cam", "export another mechanism"))
    if name is None and len(known) > 1:
        raise InvalidInput(Problem("cam", f"there are {len(known)}", f"name one: {', '.join(known)}"))
    wanted = next(iter(known)) if name is None else str(name)
    if wanted not in known:
        raise UnknownName(Problem("cam", f"there is no cam pair {wanted!r}", suggestion(wanted, list(known))))
    return known[wanted]


def _count(options: Mapping[str, Any]) -> int | None:
    """How many points are asked for, if any."""
    if options.get("points") is None:
        return None
    if options.get("tolerance") is not None:
        raise InvalidInput(Problem("points", "points and a tolerance are both given", "leave one of them out"))
    return whole("points", options["points"], FEWEST, MOST)


def _heads(found: ProfilePoints, unit: str) -> Iterator[str]:
    lengths = f" [{unit}]" if unit else ""
    yield "parameter"
    for curve in found.curves:
        yield from (f"{curve} {axis}{lengths}" for axis in "xy")
    yield from ("normal x", "normal y", f"radius of curvature{lengths}")


def _rows(found: ProfilePoints) -> Iterator[tuple[float, ...]]:
    places = [part for row in (*found.curves.values(), found.normals) for part in (row.real, row.imag)]
    # lists of Python floats, which are written with as many digits as distinguish them
    return zip(found.parameters.tolist(), *(row.tolist() for row in places), found.radii.tolist(), strict=True)


def _notes(pair: ProfileContact, found: ProfilePoints, unit: str) -> Iterator[str]:
    closed = "closed: the last is the first again" if pair.curve.closed else "open"
    yield f"{len(found.parameters)} points of the profile of {pair.name}, in the frame of {pair.on}; {closed}"
    yield f"chords between them are off by {found.error:.3g}{f' {unit}' if unit else ''} at most"
    if pair.is_flat:
        yield "a flat face has no pitch curve"


FORMAT = CamProfileFormat()
