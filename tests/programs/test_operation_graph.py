"""A graph that several threads add to at once is the one that each of them alone would make."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator

import pytest

from compoundkin.programs.graph.operation_graph import InputNumber, OperationGraph


@pytest.fixture
def _hurried() -> Iterator[None]:
    """Threads that take turns as often as they can."""
    usual = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(usual)


@pytest.mark.usefixtures("_hurried")
def test_threads_that_add_nodes_at_once_make_one_graph() -> None:
    graph = OperationGraph()
    angle = graph.input(InputNumber("drive", "crank", "0"))
    found: dict[tuple[int, int], int] = {}

    def work(own: int) -> None:
        for k in range(400):
            # every second one is wanted by all
            name = f"{own if k % 2 else 0}"
            found[own, k] = graph.apply("add", angle, graph.input(InputNumber("seed", name, str(k))))

    threads = [threading.Thread(target=work, args=(own,)) for own in range(1, 9)]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    for (own, k), node in found.items():
        _, seed = graph.nodes[node].operands
        assert graph.nodes[seed].given == InputNumber("seed", f"{own if k % 2 else 0}", str(k))
        assert node == found[1 if not k % 2 else own, k]
    assert len(graph.nodes) == 1 + 2 * (200 + 8 * 200)
