"""How the arrays of a call stand in memory, and records of them as LLVM's code reads them."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Sequence
from typing import Any

import numpy as np

from compoundkin.programs.backends.llvm.llvm_plan import ANY_STRIDE, COMPLEX, SIDE_BY_SIDE, ArrayLayout, home
from compoundkin.programs.backends.llvm.llvm_records import (
    DATA,
    DIMENSIONS,
    FLAGS,
    KIND,
    NUMBERS,
    SHAPE,
    STRIDES,
    lane_axis_of,
)
from compoundkin.programs.graph.flat_program import BY_POSE, FlatProgram

NUMBER = np.dtype(float)
WORDS_OF_RECORD = 16
# Where a tuple has its first object.
FIRST = tuple.__basicsize__


def _record(array: Any) -> Any:
    """Return what NumPy's record of an array holds, as words."""
    words = np.zeros(WORDS_OF_RECORD, np.int64)
    start = words.ctypes.data
    values = {KIND: id(np.ndarray), DATA: array.ctypes.data, DIMENSIONS: array.ndim, NUMBERS: id(array.dtype),
              FLAGS: array.flags.num, SHAPE: start + 72, STRIDES: start + 88}  # fmt: skip
    for byte, value in values.items():
        words[byte // 8] = value
    words[9:11], words[11:13] = array.shape, array.strides
    return words


def _are_records_known() -> bool:
    """Tell whether this NumPy keeps arrays as is expected here, on this Python."""
    if sys.implementation.name != "cpython":
        return False
    array = np.zeros((4, 6))[::2, ::3]
    at, words = id(array), _record(array)
    if ctypes.sizeof(ctypes.c_void_p) != 8 or array.__sizeof__() < FLAGS + 4:
        return False

    def word(place: int) -> int:
        return ctypes.c_int64.from_address(place).value

    same = all(word(at + byte) == words[byte // 8] for byte in (KIND, DATA, NUMBERS))
    same &= all(ctypes.c_int.from_address(at + byte).value == words[byte // 8] for byte in (DIMENSIONS, FLAGS))
    row = (array, same)
    if not same or [word(id(row) + FIRST + 8 * k) for k in (0, 1)] != [id(array), id(same)]:
        return False
    return all(
        [word(word(at + byte) + 8 * k) for k in (0, 1)] == list(row)
        for byte, row in ((SHAPE, array.shape), (STRIDES, array.strides))
    )


RECORDS_ARE_KNOWN = _are_records_known()


def recorded_arrays(
    program: FlatProgram, given: Sequence[int], inputs: Any, outputs: Any, shape: tuple[int, int]
) -> Any:
    """Return the arrays of a call, where their records are, and what keeps these."""
    nodes = [*(program.inputs[i] for i in given), *program.outputs]
    arrays: list[Any] = []
    for k, array in zip(nodes, (*inputs, *outputs), strict=True):
        is_output = len(arrays) >= len(given)
        found = np.asarray(array) if is_output else np.require(array, NUMBER, "A")
        if found.dtype != NUMBER or found.shape != program.shape(k, *shape):
            raise ValueError(f"an array of shape {found.shape} stands where one of {program.shape(k, *shape)} belongs")
        if is_output and not (found.flags.writeable and found.flags.aligned):
            raise ValueError("an array of results cannot be written")
        arrays.append(found.view(NUMBER) if found.dtype is not NUMBER else found)
    records = arrays if RECORDS_ARE_KNOWN else [_record(array) for array in arrays]
    places = [id(array) if RECORDS_ARE_KNOWN else array.ctypes.data for array in records]
    row = np.array(places, np.int64)
    return arrays, row.ctypes.data, (records, row)


def layout_of(program: FlatProgram, given: Sequence[int], arrays: Sequence[Any], axis: int) -> ArrayLayout:
    """Return how arrays stand along the lanes of a plan."""
    nodes = [*(program.inputs[i] for i in given), *program.outputs]
    places: dict[Any, int] = {}
    kinds: list[int] = []
    pairs: list[tuple[int, int]] = []
    for i, (k, array) in enumerate(zip(nodes, arrays, strict=True)):
        lanes = lane_axis_of(program.strata[k], axis)
        along = 1 if lanes == BY_POSE else 0
        length, stride = array.shape[along], array.strides[along]
        kinds.append(SIDE_BY_SIDE if not lanes or length == 1 or stride == NUMBER.itemsize else ANY_STRIDE)
        if not lanes or (length > 1 and stride != 2 * NUMBER.itemsize):
            continue
        other = array.strides[1 - along] if array.shape[1 - along] > 1 else 0
        role = (i < len(given), program.strata[k], home(program, k), other)
        places[role, array.ctypes.data] = i
    for (role, place), i in places.items():
        partner = places.get((role, place + NUMBER.itemsize))
        if partner is not None and not any({i, partner} & set(pair) for pair in pairs):
            pairs.append((i, partner))
            kinds[i] = kinds[partner] = COMPLEX
    return ArrayLayout(tuple(kinds), tuple(pairs))
