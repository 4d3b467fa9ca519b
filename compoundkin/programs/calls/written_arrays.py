"""What a call is told of its work: arrays to be written, and the number of threads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations
from math import prod
from typing import Any

import numpy as np

from compoundkin.base.display import short
from compoundkin.base.errors import InvalidInput, Problem, nearest
from compoundkin.base.series import Number


def hold_threads(threads: Any) -> None:
    """Raise InvalidInput for what is no number of threads."""
    if isinstance(threads, bool) or not isinstance(threads, int | np.integer) or threads < 1:
        raise InvalidInput(Problem("threads", f"{short(threads)} is no number of threads", "write 1, 2, ..."))


def held_arrays(out: Any, outputs: Mapping[str, bool], shape: tuple[int, ...]) -> dict[str, Number]:
    """Return arrays that are to be written, as designs x poses.

    `outputs` tells which are vectors. Raises InvalidInput for those that cannot hold the results.
    """
    if out is None:
        return {}
    if not isinstance(out, Mapping):
        raise InvalidInput(Problem("out", f"{short(out)} is no table by name", 'write {"G.position": array}'))
    problems = [problem for name, array in out.items() if (problem := _problem(name, array, outputs, shape))]
    problems = problems or list(_shared(out))
    if problems:
        raise InvalidInput(problems)
    return {name: array.reshape(prod(shape[:-1]), *(shape[-1:] or (1,))) for name, array in out.items()}


def _shared(out: Mapping[str, Number]) -> Iterator[Problem]:
    """Yield arrays that would be written twice."""
    for (name, array), (other, known) in combinations(out.items(), 2):
        if np.may_share_memory(array, known):
            yield Problem(f"out.{other}", f"it is in the memory of out.{name}", "give an array to each output")


def _problem(name: Any, array: Any, outputs: Mapping[str, bool], shape: tuple[int, ...]) -> Problem | None:
    where = f"out.{name}"
    if name not in outputs:
        return Problem(where, "there is no such output", nearest(name, list(outputs)))
    kind = np.dtype(complex if outputs[name] else float)
    remedy = f"give numpy.empty({shape}, {kind})"
    if not isinstance(array, np.ndarray) or array.dtype != kind:
        what = f"an array of {array.dtype}" if isinstance(array, np.ndarray) else short(array)
        return Problem(where, f"{what} is no array of {kind}", remedy)
    if array.shape != shape:
        return Problem(where, f"its shape is {array.shape}, that of the call {shape}", remedy)
    if not (array.flags.writeable and array.flags.c_contiguous):
        return Problem(where, "it cannot be written, or is not contiguous", remedy)
    return None
