"""Samples of designs and variations of dimensions."""

from __future__ import annotations

import pickle
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import stats

import compoundkin as ck
from compoundkin.kinematics.quantities import Quantity, Table
from compoundkin.programs.dimensions import FreeDimension
from compoundkin.studies.samples import SAMPLES, sample_from, sample_of
from compoundkin.studies.samples.random_samples import LatinHypercubeSample, RandomSample, SobolSample, permuted
from compoundkin.studies.samples.value_ranges import Levels
from compoundkin.studies.samples.variation import Variation
from compoundkin.studies.samples.variations import check_kinds, variation_from, variation_of, variations_of

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


UNITS = RandomSample(4096, 2).units(2, range(4096))
GIVEN: Sequence[tuple[Any, Any]] = [
    ((40, 60), stats.uniform(40, 20)),
    (ck.around(40, 0.1), stats.uniform(39.9, 0.2)),
    (ck.around(40, 0.1, sigmas=2), stats.norm(40, 0.05)),
    (stats.norm(40, scale=0.1), stats.norm(40, 0.1)),
    (stats.uniform(), stats.uniform()),
    (stats.triang(0.3, loc=2, scale=3), stats.triang(0.3, 2, 3)),
    (stats.beta(2, b=3, scale=4), stats.beta(2, 3, 0, 4)),
    (stats.truncnorm(-3, 3), stats.truncnorm(-3, 3)),
    (stats.weibull_min(1.5, 1, 2), stats.weibull_min(1.5, 1, 2)),
]
DISCRETE = (stats.randint(3, 9), stats.binom(10, 0.3), stats.poisson(2, loc=5))
POINTS: Sequence[Any] = [((1, 2), (3, 5)), (1 + 2j, 3 + 5j), ck.around((1, 2), 0.1), ck.around(1 + 2j, 0.1, sigmas=3)]


@pytest.mark.parametrize(("given", "expected"), GIVEN)
def test_values_are_distributed_as_they_should(given: Any, expected: Any) -> None:
    """By Kolmogorov and Smirnov's test, and quantile by quantile."""
    one = variation_of("a", given)
    values = one.values(UNITS[:, :1])
    assert stats.kstest(values, expected.cdf).pvalue > 1e-3
    assert np.abs(expected.cdf(values) - UNITS[:, 0]).max() < 1e-9
    assert np.allclose(one.ends, expected.support())


@pytest.mark.parametrize("given", DISCRETE)
def test_discrete_values_are_as_often_as_they_should(given: Any) -> None:
    one = variation_of("a", given)
    values = one.values(UNITS[:, :1])
    assert np.array_equal(values, given.ppf(UNITS[:, 0]))


@pytest.mark.parametrize("given", POINTS)
def test_coordinates_of_points_vary_for_themselves(given: Any) -> None:
    one = variation_of("a", given)
    values = one.values(UNITS)
    assert one.is_point
    assert abs(np.corrcoef(values.real, values.imag)[0, 1]) < 0.07
    x = np.stack([UNITS[:, 0], np.full(4096, 0.5)], axis=-1)
    assert np.array_equal(one.values(x).real, values.real)
    assert len(set(one.levels(3).tolist())) == len(one.levels(3)) == one.number_of_levels(3) == 9


@pytest.mark.parametrize("given", [*(one for one, _ in GIVEN), *DISCRETE, *POINTS, [1, 2.5], [(1, 2), (3, 4)]])
def test_what_files_say_is_read_back(given: Any) -> None:
    one = variation_of("a", given)
    again = variation_from("a", dict(one.data))
    assert again == pickle.loads(pickle.dumps(one)) == one
    assert hash(again) == hash(one)
    units = UNITS[:, : one.coordinates]
    assert np.array_equal(again.values(units), one.values(units))
    low, high = one.ends
    assert all(f(low) <= f(v) <= f(high) for v in one.values(units)[:20] for f in (np.real, np.imag))


def test_values_at_0_and_1_are_finite() -> None:
    for given in (stats.norm(40, 0.1), stats.poisson(3), ck.around(0, 1, sigmas=3)):
        found = variation_of("a", given).values(np.array([[0.0], [1.0]]))
        assert np.isfinite(found).all()
        assert found[0] < found[1]


def test_designs_are_read_from_tables(tmp_path: Path) -> None:
    """Those that `save` writes, and those that people write."""
    pytest.importorskip("pyarrow")
    turn, length = np.array([0.1, 0.2, 1 / 3]), np.array([1.0, 2.5, 3.0])
    columns = (
        Quantity("slot.angle", "rad", turn, dimension="angle"),
        Quantity("crank.B.x", "mm", length),
    )
    for suffix in (".csv", ".parquet"):
        ck.save(Table("", columns), tmp_path / f"a{suffix}")
        found = variations_of(tmp_path / f"a{suffix}")
        assert list(found) == ["slot.angle", "crank.B.x"]
        assert np.allclose(found["slot.angle"].levels(1), turn, rtol=1e-15)
        assert found["crank.B.x"] == Levels(length)
    own = tmp_path / "own.csv"
    own.write_text("\ufeffcrank.B.x, plate.C.y [mm]\n1, 2\n3, 4\n", encoding="utf-8")
    assert {name: one.levels(1).tolist() for name, one in variations_of(own).items()} == {
        "crank.B.x": [1.0, 3.0],
        "plate.C.y": [2.0, 4.0],
    }


@pytest.mark.parametrize(
    ("name", "content", "told"),
    [
        ("a.csv", b"a,b\n1,2\n3,x\n", "a.csv: could not convert string 'x' in line 3, column 2; write numbers alone"),
        ("a.csv", b"a,b\n1,2\n3\n", "a.csv: the number of columns changed from 2 to 1 in line 3"),
        ("a.csv", b"a\n1,2\n", "a.csv: it has 1 names in its first line and 2 columns of numbers"),
        ("a.csv", b"a,b\n", "a.csv: it has 2 names in its first line and 0 columns of numbers"),
        ("a.csv", b"", "a.csv: it has 0 names"),
        ("a.csv", b"a,a\n1,2\n", "a.csv: there are two columns 'a'; one for each dimension"),
        ("a.csv", b"a\n\xff\n", "a.csv: it cannot be read: it is not UTF-8 text"),
        ("a.csv", b"a\nnan\n", "dimensions.a: it is not finite"),
        ("b.csv", None, "b.csv: it cannot be read: No such file or directory"),
        ("a.parquet", b"a,b\n1,2\n", "a.parquet: it is no Parquet file"),
        ("a.json", b"{}", "a.json: designs are not read from such a file; write a .csv or .parquet"),
        ("a.xlsx", b"", "a table is not saved as '.xlsx'"),
    ],
)
def test_what_is_no_table_of_designs_is_told(tmp_path: Path, name: str, content: bytes | None, told: str) -> None:
    if name.endswith(".parquet"):
        pytest.importorskip("pyarrow")
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(ck.errors.InvalidInput) as error:
        variations_of(tmp_path / name)
    assert told in str(error.value)


def test_columns_of_tables_are_levels() -> None:
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"a": [1.0, 2.0], "b": [3, 4]})
    assert variations_of(dict(frame)) == variations_of({"a": np.array([1.0, 2.0]), "b": [3, 4]})


def test_levels_are_even() -> None:
    assert variation_of("a", (0, 10)).levels(3).tolist() == [0, 5, 10]
    assert variation_of("a", (0, 10)).levels(1).tolist() == [5]
    assert ck.around(0, 1).levels(2).tolist() == [-1, 1]
    assert np.allclose(ck.around(0, 1, sigmas=1).levels(2), stats.norm.ppf([0.25, 0.75]))
    assert variation_of("a", stats.randint(1, 4)).levels(3).tolist() == [1, 2, 3]
    assert variation_of("a", [3, 1]).levels(9).tolist() == [3, 1]


WRONG: Sequence[tuple[Any, str]] = [
    ((60, 40), "the range 60.0 to 40.0 is reversed; (40.0, 60.0)"),
    (((1, 5), (3, 2)), "the range [1.0, 5.0] to [3.0, 2.0] is reversed; ((1.0, 2.0), (3.0, 5.0))"),
    ((40, 40), "is empty; leave out a dimension that stays as it is"),
    (((1, 2), (1, 3)), "is empty"),
    ((40, np.inf), "it is not finite"),
    ((40, np.nan), "it is not finite"),
    ((40, "x"), "a text is no number"),
    ((40, (1, 2)), "one end is a number, the other a point"),
    ((1, 2, 3), "(1, 2, 3) is no range: that has two ends"),
    ((), "is no range"),
    ([], "[] has no values"),
    ([1, np.nan], "it is not finite"),
    ([[1, 2, 3]], "are neither numbers nor points"),
    (["x"], "a text is no number"),
    (3.0, "3.0 is nothing that a dimension can be; give a range (40, 60)"),
    ("x", "'x' is nothing that a dimension can be"),
    (None, "None is nothing that a dimension can be"),
    ({"low": 1}, "is nothing that a dimension can be"),
    (stats.norm, "is no distribution with its numbers; write scipy.stats.norm(40, 0.1)"),
    (stats.norm(40, -1), "these numbers do not make a distribution norm; the scale is above 0"),
    (stats.norm([1, 2], 1), "is not one number"),
    (stats.beta(-1, 2), "these numbers do not make a distribution beta"),
    (stats.rv_histogram(([1, 2], [0, 1, 2]))(), "it is no distribution that scipy.stats has by a name"),
]


@pytest.mark.parametrize(("given", "told"), WRONG)
def test_what_is_no_variation_is_told_with_its_place(given: Any, told: str) -> None:
    with pytest.raises(ck.errors.InvalidInput) as error:
        variations_of({"crank.B": given})
    assert str(error.value).startswith("dimensions.crank.B")
    assert told in str(error.value)


def test_all_that_is_wrong_is_told_at_once() -> None:
    with pytest.raises(ck.errors.InvalidInput) as error:
        variations_of({"a": (2, 1), "b": (1, 2), "c": None})
    assert [problem.where for problem in error.value.problems] == ["dimensions.a", "dimensions.c"]
    with pytest.raises(ck.errors.InvalidInput, match="dimensions: there is none"):
        variations_of({})


@pytest.mark.parametrize(
    ("data", "told"),
    [
        ({}, "just one of these keys: low, distribution, centre, values"),
        ({"low": 1, "centre": 2}, "just one of these keys"),
        ({"low": 1}, "a: it has no 'high'; say low and high"),
        ({"low": 1, "high": 2, "sigmas": 3}, "a.sigmas: there is no such key; known: low, high"),
        ({"distribution": "nrm"}, "did you mean 'norm'?"),
        ({"distribution": 3}, "scipy.stats has no distribution 3"),
        ({"distribution": "beta", "shape": [1]}, "a.shape: the distribution beta has 2 numbers of its shape, not 1"),
        ({"distribution": "norm", "scale": 0}, "these numbers do not make a distribution norm"),
        ({"centre": 1, "within": -1}, "a.within: -1 is no distance above 0"),
        ({"centre": 1, "within": 1, "sigmas": 0}, "a.sigmas: 0 is no number above 0"),
        ({"values": 3}, "are neither numbers nor points"),
    ],
)
def test_what_files_say_wrong_is_told(data: dict[str, Any], told: str) -> None:
    with pytest.raises(ck.errors.InvalidInput) as error:
        variation_from("a", data)
    assert told in str(error.value)


def test_points_and_numbers_are_not_mixed_up() -> None:
    dimensions = [FreeDimension("p.B", "p", "B", is_of_link=True), FreeDimension("p.C.x", "p", "C", "x", True)]
    check_kinds(variations_of({"p.B": ((1, 2), (3, 4)), "p.C.x": (1, 2)}), dimensions)
    with pytest.raises(ck.errors.InvalidInput) as error:
        check_kinds(variations_of({"p.B": (1, 2), "p.C.x": [(1, 2)]}), dimensions)
    first, second = map(str, error.value.problems)
    assert first.startswith("dimensions.p.B: it is a point, and numbers are given; give points, as in ((x, y), (x, y))")
    assert second.startswith("dimensions.p.C.x: it is a number, and points are given")
