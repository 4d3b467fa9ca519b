"""`dxf`: what CAD programs and laser cutters read. Written by ezdxf; not read, since lines say too little."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any, ClassVar

from compoundkin.base.errors import Problem, UnknownName, suggestion
from compoundkin.files.exchange.contract import Writable
from compoundkin.files.exchange.dxf.coupler_paths import coupler_paths, drawn_letters, whole_motion
from compoundkin.files.exchange.dxf.ezdxf_library import ezdxf, fixed_dates
from compoundkin.files.exchange.dxf.legal_names import in_ascii
from compoundkin.files.exchange.dxf.link_parts import LinkPart, link_parts
from compoundkin.files.exchange.dxf.part_layout import draw_parts
from compoundkin.files.exchange.dxf.pose_layers import CENTRES, LAYERS, NAMES, draw_paths, draw_pose
from compoundkin.files.exchange.dxf.profile_splines import profile_spline
from compoundkin.files.exchange.exchanged import Exported
from compoundkin.files.exchange.option_values import flag, letters_of, positive
from compoundkin.files.exchange.shown_mechanism import ShownMechanism
from compoundkin.model.geometry import FRAME

# The number of each unit of length in $INSUNITS; the version whose files all programs read that know splines.
UNITS: Mapping[str, int] = MappingProxyType({"in": 1, "ft": 2, "mm": 4, "cm": 5, "m": 6, "um": 13, "dm": 14})
METRIC, ENGLISH, NO_UNIT = 1, 0, 0
VERSION = "R2000"
POSE_LAYERS = tuple(name for name in LAYERS if name != CENTRES)
# How far curves may be off where it is not said, in parts of the mechanism's size.
CHORD = 1e-4
# No drawing is finer than this part of the mechanism's size.
FINEST = 1e-8


class DxfFormat(Writable):
    """Links as blocks at true size on layers; or the parts side by side."""

    name: ClassVar[str] = "dxf"
    program: ClassVar[str] = "CAD programs, laser cutters"
    title: ClassVar[str] = "DXF drawing"
    suffix: ClassVar[str] = ".dxf"
    options: ClassVar[Mapping[str, str]] = MappingProxyType(
        {
            "curves": "points whose paths are drawn, by commas; if left out those of outputs and of one link alone",
            "tolerance": "how far curves may be off, a length; 1/10000 of the mechanism's size if left out",
            "parts": "instead of a pose the parts side by side, as a laser cuts them: contours and holes alone",
        }
    )

    def write(self, shown: ShownMechanism, **options: Any) -> Exported:
        """Return the file. Raises InvalidInput where ezdxf is not installed or there is nothing to cut."""
        library = ezdxf(f".{self.name}")
        size = shown.mechanism.geometry.size
        tolerance = positive("tolerance", options.get("tolerance"), CHORD * size, FINEST * size)
        letters = _letters(shown, options.get("curves"))
        as_parts = flag("parts", options.get("parts"))
        motion = whole_motion(shown)
        parts = link_parts(shown, motion)
        splines = {id(curve): profile_spline(curve, tolerance) for part in parts for curve in part.profiles}
        paths = () if motion is None or as_parts else coupler_paths(motion, letters, tolerance)
        with fixed_dates(library):
            document = _document(library, shown, (NAMES, CENTRES) if as_parts else POSE_LAYERS)
            if as_parts:
                draw_parts(document, parts, splines, size)
            else:
                draw_pose(document, shown, parts, splines, size)
                draw_paths(document, paths)
            content = _content(document)
        errors = [*(path.error for path in paths), *(spline.error for spline in splines.values())]
        error = max(tolerance, *errors) if errors else None
        instead = "left out" if as_parts else "drawn as lines between their points"
        return Exported(content, self.name, tuple(_notes(shown, parts, error, instead)))


def _letters(shown: ShownMechanism, asked: Any) -> Sequence[str]:
    """The letters of paths; raises UnknownName."""
    if asked is None:
        return drawn_letters(shown)
    known = [letter for letter, links in shown.mechanism.carriers.items() if FRAME not in links]
    found = letters_of("curves", asked)
    for letter in found:
        if letter not in known:
            raise UnknownName(Problem("curves", f"no point {letter!r} moves", suggestion(letter, known)))
    return found


def _document(library: Any, shown: ShownMechanism, layers: Sequence[str]) -> Any:
    document = library.new(VERSION)
    unit = shown.mechanism.unit
    document.header["$INSUNITS"] = UNITS.get(unit, NO_UNIT)
    document.header["$MEASUREMENT"] = ENGLISH if unit in ("in", "ft") else METRIC
    for name in layers:
        document.layers.add(name, color=LAYERS[name])
    return document


def _content(document: Any) -> bytes:
    text = io.StringIO()
    document.write(text)
    return in_ascii(text.getvalue())


def _notes(shown: ShownMechanism, parts: Sequence[LinkPart], error: float | None, instead: str) -> Iterator[str]:
    unit = shown.mechanism.unit
    if not unit:
        yield "the lengths have no unit"
    elif unit not in UNITS:
        yield f"DXF has no number for the unit {unit!r}; lengths are written as they are"
    if error is not None:
        yield f"curves are within {error:.3g}{f' {unit}' if unit else ''} of the exact ones"
    if bare := [part.link for part in parts if not part.is_cut and part.link != FRAME]:
        yield f"links without an outline, {instead}: {', '.join(bare)}"


FORMAT = DxfFormat()
