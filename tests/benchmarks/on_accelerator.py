"""Six-bar poses a second under JAX: `python -m tests.benchmarks.on_accelerator 1000000000`, on any device.

The sum over all poses of the squared distances of G from a point, crank angles made on the device, so that nothing but
the sum leaves it; in single and in double precision, position alone and with velocity and acceleration. Each sum is
held against that of fewer poses by NumPy.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Any

import numpy as np

import compoundkin as ck
from tests.benchmarks import six_bar
from tests.benchmarks.__main__ import heading, row

TURN = 36_000
TARGET = 20.0 - 10.0j
OUTPUTS = {
    "position": ("G.position",),
    "with velocity and acceleration": ("G.position", "G.velocity", "G.acceleration"),
}


def cost(found: Any) -> Any:
    """The squared distance of G from the target, and the squares of its rates."""
    rates = (abs(found[name]) ** 2 for name in OUTPUTS["with velocity and acceleration"][1:] if name in found)
    return sum(rates, abs(found["G.position"] - TARGET) ** 2)


def summed(outputs: tuple[str, ...], count: int) -> Callable[[], Any]:
    """The mean cost over so many poses, as one program of the device."""
    import jax
    import jax.numpy as jnp

    function = ck.compile(six_bar.mechanism(), outputs).jax()

    def program(step: Any) -> Any:
        crank = (jnp.arange(count) % TURN) * step
        return cost(function({"crank": crank}, speed=six_bar.SPEED)).mean()

    compiled, step = jax.jit(program), 2 * np.pi / TURN
    return lambda: compiled(step).block_until_ready()


def expected(outputs: tuple[str, ...]) -> float:
    """The mean cost over a full turn."""
    g = six_bar.by_hand(np.arange(TURN) * (2 * np.pi / TURN))["G"]
    return float(np.mean(cost({name: g[k] for k, name in enumerate(outputs)})))


def measured(count: int) -> dict[str, tuple[float, float]]:
    """Seconds a pose at best, and the relative error of the mean, by precision and outputs."""
    import jax

    contexts: dict[str, Callable[[], AbstractContextManager[Any]]] = {"single": nullcontext, "double": jax.enable_x64}
    found = {}
    for digits, context in contexts.items():
        for label, outputs in OUTPUTS.items():
            with context():
                call, seconds = summed(outputs, count), []
                value = call()
                for _ in range(5):
                    start = time.perf_counter()
                    call()
                    seconds.append(time.perf_counter() - start)
            found[f"{digits}, {label}"] = min(seconds) / count, abs(float(value) / expected(outputs) - 1.0)
    return found


def main(count: int) -> None:
    """Print a table."""
    import jax

    heading(f"{count:,} six-bar poses summed by JAX {jax.__version__} on {jax.devices()[0].device_kind}")
    for label, (seconds, error) in measured(count).items():
        row(label[:30], seconds, f"{1e-9 / seconds:.3f} billion poses a second, mean off by {error:.1e}")


if __name__ == "__main__":
    main(TURN * max(1, round(int(sys.argv[1] if len(sys.argv) > 1 else 3_600_000) / TURN)))
