"""Loops and conditions in LLVM's language, written as blocks of Python."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import count


class ControlText:
    """Lines of code with loops; the writer knows in which block it is."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.block = "entry"
        self._numbers = count(1)

    def put(self, code: str) -> str:
        """Write one instruction and return the name of its value."""
        name = f"%v{next(self._numbers)}"
        self.lines.append(f"  {name} = {code}")
        return name

    def do(self, code: str) -> None:
        """Write an instruction that has no value."""
        self.lines.append(f"  {code}")

    def label(self, name: str) -> None:
        """Begin a block."""
        self.lines.append(f"{name}:")
        self.block = name

    def whole(self, operation: str, a: str | int, b: str | int) -> str:
        """Write an operation on whole numbers."""
        return self.put(f"{operation} i64 {a}, {b}")

    def least(self, a: str | int, b: str | int) -> str:
        """Write the lesser of two whole numbers."""
        return self.put(f"call i64 @llvm.smin.i64(i64 {a}, i64 {b})")

    def words(self, base: str, offset: str | int) -> str:
        """Write the place so many words behind another."""
        return self.put(f"getelementptr i64, ptr {base}, i64 {offset}")

    def loaded(self, base: str, offset: str | int, kind: str = "i64") -> str:
        """Write the reading of a word."""
        return self.put(f"load {kind}, ptr {self.words(base, offset)}")

    @contextmanager
    def steps(self, start: str | int, stop: str | int, step: int = 1) -> Iterator[str]:
        """Write a loop that counts."""
        n = next(self._numbers)
        before, at = self.block, len(self.lines) + 2
        self.do(f"br label %test{n}")
        self.label(f"test{n}")
        self.lines.append("")
        self.do(f"%go{n} = icmp slt i64 %i{n}, {stop}")
        self.do(f"br i1 %go{n}, label %body{n}, label %exit{n}")
        self.label(f"body{n}")
        yield f"%i{n}"
        self.do(f"%next{n} = add i64 %i{n}, {step}")
        self.do(f"br label %test{n}")
        self.lines[at] = f"  %i{n} = phi i64 [ {start}, %{before} ], [ %next{n}, %{self.block} ]"
        self.label(f"exit{n}")

    @contextmanager
    def when(self, truth: str) -> Iterator[None]:
        """Write what is done only where something is true."""
        n = next(self._numbers)
        self.do(f"br i1 {truth}, label %then{n}, label %after{n}")
        self.label(f"then{n}")
        yield
        self.do(f"br label %after{n}")
        self.label(f"after{n}")
