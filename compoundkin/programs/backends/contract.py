"""What every back end answers: it makes a runner of a flat program, which computes arrays from arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

from compoundkin.programs.graph.flat_program import FlatProgram


class Runner(Protocol):
    """A program that can be run.

    `inputs` are float64 arrays, one for each of `program.inputs`, each (1 or designs, 1 or poses) as its stratum says
    (any strides). `outputs` are float64 arrays to be written, one for each of `program.outputs`, of exactly the shape
    of its stratum (any strides: real parts of complex arrays among them); truths are written as 0.0 and 1.0.
    `shape` is designs x poses. Results do not depend on the number of `threads`.
    """

    def __call__(self, inputs: Sequence[Any], outputs: Sequence[Any], shape: tuple[int, int], threads: int = 1) -> None:
        """Compute the outputs."""


class BackEnd(Protocol):
    """A way to compute flat programs."""

    def runner(self, program: FlatProgram) -> Runner:
        """Make a program ready to run."""
