"""The kinds of samples: one file each, and this registry by their words."""

from __future__ import annotations

from compoundkin.base.errors import InvalidInput, Problem, nearest
from compoundkin.studies.samples.contract import DesignSample
from compoundkin.studies.samples.sobol import SobolSample

SAMPLES = {kind.word: kind for kind in (SobolSample,)}


def sample_of(given: object, count: int | None, seed: int) -> DesignSample:
    """Return the sample of a word; raises InvalidInput for what is none."""
    if isinstance(given, DesignSample):
        return given
    if not isinstance(given, str) or given not in SAMPLES:
        raise InvalidInput(Problem("sample", f"there is no sample {given!r}", nearest(str(given), list(SAMPLES))))
    if count is None:
        raise InvalidInput(Problem("count", "it is not said how many designs", "count=2**16"))
    return SAMPLES[given](count, seed)
