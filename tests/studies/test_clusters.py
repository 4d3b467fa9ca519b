"""The page on clusters is true: its study runs on a cluster of processes, one of which is killed meanwhile."""

from __future__ import annotations

import os
import re
import signal
from pathlib import Path
from typing import Any

import pytest

import compoundkin as ck
from tests.source import ROOT
from tests.studies.test_study import assert_same


@pytest.mark.full
def test_the_page_on_clusters_runs_though_a_worker_is_killed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("distributed")
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "clusters.md").read_text("utf-8"), re.DOTALL)
    text = "\n".join(block for block in blocks if "import dask" not in block and "from dask" not in block)
    told: list[int] = []

    def kill(done: int, count: int) -> None:
        told.append(done)
        if len(told) == 2:
            os.kill(min(names["client"].run(os.getpid).values()), signal.SIGKILL)

    names: dict[str, Any] = {"__name__": "__main__", "kill": kill}
    exec(text.replace("on=client)", "on=client, progress=kill)"), names)
    # nobody's rows were lost, and nobody's are there twice
    assert told == list(range(0, 2**14 + 1, 4096))
    assert_same(names["again"], names["study"].run())
    assert capsys.readouterr().out.startswith(f"{names['result']!r}\n")
    assert len(list(Path("six-bar-study").iterdir())) == 5


def test_who_cannot_compute_is_told(tmp_path: Path) -> None:
    study = ck.study(ck.load("crank-rocker"), {"crank.B.x": (0.9, 1.1)}, "C", count=4)

    class Asynchronous:
        asynchronous = True
        get_executor = nthreads = dict

    for on, told in ((object, "cluster.get_client"), (Asynchronous(), "asynchronous=False")):
        with pytest.raises(ck.errors.InvalidInput, match=told):
            study.run(tmp_path / "folder", on=on)
    with pytest.raises(ck.errors.InvalidInput, match="leave out threads or on"):
        study.run(on=Asynchronous(), threads=2)
