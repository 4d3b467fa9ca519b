"""The kinds of samples: one file each, and this registry by their words."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from compoundkin.base.display import short
from compoundkin.base.errors import InvalidInput, Problem, nearest
from compoundkin.studies.samples.contract import DesignSample
from compoundkin.studies.samples.grid_of_levels import GridSample
from compoundkin.studies.samples.latin_hypercube import LatinHypercubeSample
from compoundkin.studies.samples.listed_rows import TableSample
from compoundkin.studies.samples.random_rows import RandomSample
from compoundkin.studies.samples.sobol import SobolSample
from compoundkin.studies.variations.contract import Variation

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
    that do not suit the sample. With what a sample's `data` say it is made again.
    """
    if isinstance(sample, DesignSample):
        return sample
    if isinstance(sample, Mapping):
        return GridSample.with_levels(sample, count, variations)
    if not isinstance(sample, str) or sample not in SAMPLES:
        known = nearest(sample, list(SAMPLES)) if isinstance(sample, str) else f"known: {', '.join(SAMPLES)}"
        raise InvalidInput(Problem("sample", f"there is no sample {short(sample)}", known))
    return SAMPLES[sample].of(count, seed, variations)
