"""LLVM itself, through llvmlite: text made into code for this processor, once for all processes."""

from __future__ import annotations

import ctypes
import ctypes.util
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from typing import Any

import llvmlite.binding as llvm

from compoundkin.programs.backends.llvm.llvm_plan import Machine
from compoundkin.programs.backends.llvm.object_cache import cached_object, keep_object

# What code may call of the system's library: large angles, and rounding on processors without an instruction for it.
LIBRARY = ("sin", "cos", "floor", "ceil", "rint", "fma")
NUMBER, PLACE = ctypes.c_ssize_t, ctypes.c_void_p
RUN = ctypes.CFUNCTYPE(ctypes.c_int, PLACE, PLACE, *[NUMBER] * 6, PLACE, NUMBER, NUMBER)


@dataclass(frozen=True)
class CompiledCode:
    """Code in memory, which lives as long as its engine does."""

    engine: Any
    run: Any


@cache
def target() -> tuple[Machine, str]:
    """Return what of this processor decides on the text, and its name."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    _name_library()
    has = {name for name, there in llvm.get_host_cpu_features().items() if there}
    triple = llvm.get_process_triple()
    lanes = 16 if "avx512f" in has else 8 if "avx" in has else 4
    has_fma = "fma" in has or triple.startswith(("aarch64", "arm64"))
    version = ".".join(map(str, llvm.llvm_version_info))
    name = f"{version} {triple} {llvm.get_host_cpu_name()} {' '.join(sorted(has))}"
    return Machine(lanes, has_fma, "avx512bw" in has), name


def _new_machine() -> Any:
    """Return LLVM's machine for this processor; an engine takes it for its own."""
    return llvm.Target.from_triple(llvm.get_process_triple()).create_target_machine(
        cpu=llvm.get_host_cpu_name(),
        features=llvm.get_host_cpu_features().flatten(),
        opt=2,
        reloc="pic",
        codemodel="small",
        jit=True,
    )


def _name_library() -> None:
    """Tell LLVM where the system's functions are."""
    with suppress(OSError, AttributeError, TypeError):
        library = ctypes.CDLL(ctypes.util.find_library("m") or ctypes.util.find_library("msvcrt"))
        for name in LIBRARY:
            llvm.add_symbol(name, ctypes.cast(getattr(library, name), ctypes.c_void_p).value)


def compiled(text: str) -> CompiledCode:
    """Return the code of a text, from disk where it was compiled before."""
    key = f"{target()[1]}\n{text}"
    machine = _new_machine()
    content = cached_object(key)
    if content is None:
        content = machine.emit_object(llvm.parse_assembly(text))
        keep_object(key, content)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
    engine.add_object_file(llvm.ObjectFileRef.from_data(content))
    engine.finalize_object()
    return CompiledCode(engine, RUN(engine.get_function_address("run")))
