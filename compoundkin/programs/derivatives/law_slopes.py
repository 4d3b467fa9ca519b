"""Slopes by numbers of driving laws: those by a driver's value and rates, times those of the law at the same times."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.kinematics.driver_values import fit
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.laws.law_numbers import law_sensitivities
from compoundkin.programs.call_numbers import Call, CallNumbers
from compoundkin.programs.dimensions import FreeDimension, drives_of_call
from compoundkin.programs.graph.operation_graph import DRIVE, LAW_SLOPE, InputNumber


def with_law_slopes(
    numbers: CallNumbers, order: SolvingOrder, call: Call, values: Mapping[FreeDimension, Number], highest: int
) -> CallNumbers:
    """Return the numbers of a call with the slopes of laws by their free numbers, zero where no law moves.

    They are those of the drivers' values and of their rates up to the `highest` derivative.
    """
    drives = {one.name: one for one in drives_of_call(order.structure.mechanism.drives, values)}
    times, fitted = call.times(order, tuple(drives.values())), fit(numbers.shape)
    found = dict(numbers.given)
    for one in (each for each in values if each.is_of_law):
        slopes = [0.0] * (highest + 1)
        if times is not None:
            slopes = law_sensitivities(drives[one.owner].law, one.part, times, highest)
        for k, slope in enumerate(slopes):
            found[_law_slope(one, k)] = np.atleast_2d(np.asarray(fitted(slope), float))
    return replace(numbers, given=found)


def slope_inputs(dimensions: Sequence[FreeDimension], order: int) -> dict[str, tuple[InputNumber, ...]]:
    """Return the inputs that slopes are by.

    For a number of a law they are the driver's value and rates, each by itself.
    """
    found: dict[str, tuple[InputNumber, ...]] = {}
    for one in dimensions:
        if one.is_of_law:
            found |= {_slope_label(one, k): (InputNumber(DRIVE, one.owner, str(k)),) for k in range(order + 1)}
        else:
            found[one.name] = one.inputs
    return found


def law_slope_parts(one: FreeDimension, numbers: CallNumbers, slopes: Mapping[str, Number], order: int) -> list[Number]:
    """Return the parts of a slope by a number of a law.

    One is that of the driver's value, the others those of its rates.

    `slopes` are those by the driver's value and rates, by the labels of `slope_inputs`.
    """
    return [slopes[_slope_label(one, k)] * numbers.given[_law_slope(one, k)] for k in range(order + 1)]


def summed_slopes(
    dimensions: Sequence[FreeDimension], numbers: CallNumbers, slopes: Mapping[str, Number], order: int
) -> dict[str, Number]:
    """Return the slopes of a sum over the poses by all dimensions."""
    return {
        one.name: sum(part.sum(axis=1, keepdims=True) for part in law_slope_parts(one, numbers, slopes, order))
        if one.is_of_law
        else slopes[one.name]
        for one in dimensions
    }


def _law_slope(one: FreeDimension, k: int) -> InputNumber:
    return InputNumber(LAW_SLOPE, one.name, str(k))


def _slope_label(one: FreeDimension, k: int) -> str:
    return f"{one.name} {k}"
