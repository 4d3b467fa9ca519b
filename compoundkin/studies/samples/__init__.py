"""The kinds of samples: one file each, and this registry by their words."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem, suggestion
from compoundkin.studies.samples.design_sample import DesignSample
from compoundkin.studies.samples.grid_sample import GridSample, TableSample
from compoundkin.studies.samples.random_samples import LatinHypercubeSample, RandomSample, SobolSample
from compoundkin.studies.samples.variation import Variation

KINDS_OF_SAMPLES: tuple[type[DesignSample], ...] = (
    SobolSample,
    LatinHypercubeSample,
    RandomSample,
    GridSample,
    TableSample,
)
SAMPLES: Mapping[str, type[DesignSample]] = MappingProxyType({kind.word: kind for kind in KINDS_OF_SAMPLES})


def sample_of(
    sample: object, count: int | None = None, seed: int = 0, variations: Mapping[str, Variation] = MappingProxyType({})
) -> DesignSample:
    """Return the sample of a word, or the grid of some levels, for variations.

    Levels are numbers by dimensions: {"crank.B": 5}.

    Raises InvalidInput for what is none, UnknownName for levels of what is no dimension; warns LikelySlip of counts
    that do not suit the sample.
    """
    if isinstance(sample, DesignSample):
        return sample
    if isinstance(sample, Mapping):
        return GridSample.with_levels(sample, count, variations)
    return _kind(sample).of(count, seed, variations)


def sample_from(data: Mapping[str, Any]) -> DesignSample:
    """Return the sample of plain `data`; raises InvalidInput.

    It was held against variations when it was made: nothing is warned of, and they are not needed.
    """
    sample = data.get("sample")
    return (GridSample if isinstance(sample, Mapping) else _kind(sample)).read(data)


def _kind(sample: object) -> type[DesignSample]:
    if not isinstance(sample, str) or sample not in SAMPLES:
        known = suggestion(sample, list(SAMPLES)) if isinstance(sample, str) else f"known: {', '.join(SAMPLES)}"
        raise InvalidInput(Problem("sample", f"there is no sample {short_repr(sample)}", known))
    return SAMPLES[sample]
