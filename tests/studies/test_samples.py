"""Samples of designs: any rows alone are those in bulk, and each kind is what its name says."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy import stats

import compoundkin as ck
from compoundkin.studies.samples import SAMPLES, sample_from, sample_of
from compoundkin.studies.samples.random_sample import LatinHypercubeSample, RandomSample, permuted
from compoundkin.studies.samples.sobol import SobolSample
from compoundkin.studies.samples.variation import Variation
from compoundkin.studies.samples.variations import variations_of

LISTED = variations_of({"a": [1.0, 2.0, 3.0, 4.0] * 16, "b": [(k, -k) for k in range(64)], "c": range(64)})
VARIED = variations_of(
    {"a": (40, 60), "b": ((0, 1), (2, 4)), "c": ck.around(5, 0.1, sigmas=3), "d": [1, 2, 5], "e": stats.norm(1, 2)}
)
RANGES = variations_of({"a": (40, 60), "b": ((0, 1), (2, 4))})
OF_UNITS = (SobolSample, RandomSample, LatinHypercubeSample)


@pytest.mark.parametrize("word", SAMPLES)
def test_rows_alone_are_those_in_bulk(word: str) -> None:
    own = LISTED if word == "table" else VARIED
    count = {"table": 64, "grid": 3 * 4**5}.get(word, 1 << 10)
    sample = sample_of(word, count, 7, own)
    whole = sample.designs(own, range(count))
    for rows in (range(count - 1, count), range(1), range(13, 45), range(5, 5)):
        some = sample.designs(own, rows)
        for name, values in whole.items():
            assert some[name].tobytes() == values[rows.start : rows.stop].tobytes()
    assert sample_of(**sample.data, variations=own) == sample == sample_from(sample.data)


@pytest.mark.parametrize("kind", OF_UNITS)
def test_rows_beyond_many_others_are_made_at_once(kind: type[Any]) -> None:
    sample = kind(2**22, 3)
    assert np.array_equal(sample.units(3, range(2**21 - 2, 2**21 + 2))[2:], sample.units(3, range(2**21, 2**21 + 2)))
    assert not np.array_equal(sample.units(3, range(4)), kind(2**22, 4).units(3, range(4)))


def test_sobol_is_that_of_scipy() -> None:
    expected = stats.qmc.Sobol(5, scramble=True, seed=np.random.default_rng(9)).random(2**12)
    assert np.array_equal(SobolSample(2**12, 9).units(5, range(2**12)), expected)
    assert np.array_equal(SobolSample(2**20, 9).units(5, range(1000, 1100)), expected[1000:1100])
    assert np.array_equal(SobolSample(1, 9).units(5, range(1)), expected[:1])


@pytest.mark.parametrize("count", [1, 2, 3, 10, 97, 1024])
def test_each_stratum_of_a_latin_hypercube_has_one_design(count: int) -> None:
    units = LatinHypercubeSample(count, 5).units(6, range(count))
    assert np.array_equal(np.sort(np.floor(units * count), axis=0), np.tile(np.arange(count)[:, None], 6))


def test_strata_of_a_thousand_million_designs_are_kept() -> None:
    """Rounding is greatest in the last ones."""
    count = 2**30
    rows = range(count - 2000, count)
    units = LatinHypercubeSample(count, 1).units(2, rows)
    strata = permuted(np.arange(rows.start, rows.stop), count, 1, 0)
    assert np.array_equal(np.floor(units[:, 0] * count), strata)
    assert len(set(strata.tolist())) == 2000
    extreme = (count - 1 + 1.0 - 2.0**-20) / count
    assert np.floor(extreme * count) == count - 1


@pytest.mark.parametrize("kind", [RandomSample, LatinHypercubeSample])
def test_columns_are_even_and_independent(kind: type[Any]) -> None:
    """Kolmogorov and Smirnov's test of each column, correlations of columns and of neighbouring rows."""
    count = 2**14
    units = kind(count, 11).units(5, range(count))
    assert min(stats.kstest(column, "uniform").pvalue for column in units.T) > 1e-3
    both = np.concatenate([units[:-1], units[1:]], axis=1)
    assert np.abs(np.corrcoef(both, rowvar=False) - np.eye(10)).max() < 4.5 / np.sqrt(count)
    cells = np.histogram2d(units[:, 0], units[:, 1], bins=16)[0]
    assert stats.chisquare(cells.ravel()).pvalue > 1e-3


def test_permutations_of_small_numbers_are_all_found() -> None:
    """All 24 of four numbers, about as often."""
    found = np.array([permuted(np.arange(4), 4, seed, 0) for seed in range(1200)])
    _, often = np.unique(found, axis=0, return_counts=True)
    assert len(often) == 24
    assert stats.chisquare(often).pvalue > 1e-3


def test_a_grid_has_all_combinations() -> None:
    own = variations_of({"a": (0, 1), "b": ((0, 10), (1, 12)), "c": [7, 9]})
    found = sample_of({"a": 3, "b": 2}, variations=own).designs(own, range(24))
    rows = [(a, complex(x, y), c) for a in (0, 0.5, 1) for x in (0, 1) for y in (10, 12) for c in (7, 9)]
    assert list(zip(*(one.tolist() for one in found.values()), strict=True)) == rows
    assert sample_of("grid", 27 * 2, 0, own).data["sample"] == {"a": 3, "b": 3, "c": 3}
    assert sample_of("grid", variations=LISTED).count == 64**3


def test_a_table_has_its_rows() -> None:
    sample = sample_of("table", variations=LISTED)
    assert sample.count == 64
    assert sample.designs(LISTED, range(2, 4))["b"].tolist() == [2 - 2j, 3 - 3j]


@pytest.mark.parametrize(
    ("sample", "count", "variations", "told"),
    [
        ("sobl", 4, RANGES, "sample: there is no sample 'sobl'; did you mean 'sobol'?"),
        (3, 4, RANGES, "sample: there is no sample 3; known: sobol, latin-hypercube"),
        ("sobol", None, RANGES, "count: it is not said how many designs"),
        ("random", 0, RANGES, "count: 0 is no number of designs; 1 to 1073741824"),
        ("random", 2.5, RANGES, "count: 2.5 is no number of designs"),
        ("random", 2**40, RANGES, "count: 1099511627776 is no number of designs"),
        ("grid", 26, RANGES, "no grid has 26 designs; 8 or 27, or levels of each: sample={'a': 5"),
        ("grid", None, RANGES, "count: it is not said how many designs"),
        ({"a": 3, "x": 2}, None, RANGES, "sample.x: it is not among the dimensions"),
        ({"a": 3}, None, RANGES, "sample.b: it is not said how many levels it has"),
        ({"a": 3, "b": 2.5}, None, RANGES, "sample.b: 2.5 is no number of levels"),
        ({"a": 3, "b": 3}, 20, RANGES, "count: the grid has 27 designs, not 20"),
        ({"a": 3, "b": 2**20}, None, RANGES, "count: the grid has 3298534883328 designs"),
        ("table", None, RANGES, "dimensions.a: in a table it is a list of values"),
        ("table", None, {**LISTED, **variations_of({"d": [1]})}, "dimensions.d: it has 1 values, and a has 64"),
        ("table", 63, LISTED, "count: the table has 64 rows, not 63"),
    ],
)
def test_what_is_no_sample_is_told(sample: Any, count: Any, variations: dict[str, Variation], told: str) -> None:
    with pytest.raises(ck.errors.CompoundkinError) as error:
        sample_of(sample, count, 0, variations)
    assert told in str(error.value)


def test_seeds_and_columns_are_held() -> None:
    for seed in (-1, 2.5, "x", None):
        with pytest.raises(ck.errors.InvalidInput, match=r"seed: .* is no seed; a whole number from 0"):
            sample_of("random", 4, seed, RANGES)  # type: ignore[arg-type]
    many = variations_of({str(k): (0, 1) for k in range(21202)})
    with pytest.raises(ck.errors.InvalidInput, match="21202 numbers a design, and Sobol's sequence has 21201"):
        sample_of("sobol", 4, 0, many)
    with pytest.warns(ck.errors.LikelySlip, match="1000 is none; take count=512 or 1024"):
        sample_of("sobol", 1000, 0, RANGES)
