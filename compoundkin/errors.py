"""What can go wrong: every error says where, what, and how to mend it.

>>> from compoundkin.errors import CompoundkinError, InvalidInput
>>> issubclass(InvalidInput, CompoundkinError)
True
"""

from __future__ import annotations

from compoundkin.base.errors import (
    ChangePointWarning,
    CompoundkinError,
    DrawnBeyondEnd,
    FewDigits,
    InvalidInput,
    InvalidMechanism,
    LikelySlip,
    NearChangePoint,
    NotAssembled,
    NotDetermined,
    Problem,
    StudyStopped,
    UnassembledPoses,
    UnknownName,
    UnmetConstraints,
    WedgedPoses,
)

__all__ = [
    "ChangePointWarning",
    "CompoundkinError",
    "DrawnBeyondEnd",
    "FewDigits",
    "InvalidInput",
    "InvalidMechanism",
    "LikelySlip",
    "NearChangePoint",
    "NotAssembled",
    "NotDetermined",
    "Problem",
    "StudyStopped",
    "UnassembledPoses",
    "UnknownName",
    "UnmetConstraints",
    "WedgedPoses",
]
