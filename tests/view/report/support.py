"""A mechanism that several tests of reports change."""

from __future__ import annotations

from typing import Any

import compoundkin as ck


def four_bar(frame: Any = 4.0, *more: Any, **words: Any) -> ck.Mechanism:
    return ck.Mechanism(
        "Four-bar",
        ck.link("frame", A=(0, 0), D=(frame, 0)),
        ck.link("crank", A=(0, 0), B=(1, 0)),
        ck.link("coupler", B=(0, 0), C=(3, 0), P=(1, 1)),
        ck.link("rocker", D=(0, 0), C=(3, 0)),
        *more,
        **words,
    )
