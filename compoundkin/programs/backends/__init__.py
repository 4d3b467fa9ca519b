"""Back ends: what computes a flat program; the first that is installed is taken."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec

from compoundkin.base.errors import InvalidInput, Problem, missing_extra
from compoundkin.programs.backends.runner import BackEnd, Runner
from compoundkin.programs.graph.flat_program import FlatProgram


def _llvm() -> BackEnd:
    """Return the back end that compiles; its package is an extra."""
    from compoundkin.programs.backends.llvm_backend import Llvm

    return Llvm()


def _tape() -> BackEnd:
    """Return the back end that NumPy alone needs; pages record programs and run none."""
    from compoundkin.programs.backends.tape_backend import Tape

    return Tape()


# By their names, the fastest first: the module that must be installed, and what makes one.
BACK_ENDS: dict[str, tuple[str, Callable[[], BackEnd]]] = {
    "llvm": ("llvmlite", _llvm),
    "numpy": ("numpy", _tape),
}


def runner_of(program: FlatProgram, backend: str | None = None) -> Runner:
    """Return a program made ready by a back end."""
    return BACK_ENDS[chosen_back_end(backend)][1]().runner(program)


def chosen_back_end(name: str | None = None) -> str:
    """Return the back end to take. It is the one named, or the fastest installed.

    Raises InvalidInput for a name that there is not, or whose package is not installed.

    >>> chosen_back_end("numpy")
    'numpy'
    """
    installed = [each for each, (module, _) in BACK_ENDS.items() if find_spec(module)]
    if name is None:
        return installed[0]
    if name not in BACK_ENDS:
        raise InvalidInput(Problem("backend", f"there is no back end {name!r}", f"known: {', '.join(BACK_ENDS)}"))
    if name not in installed:
        raise missing_extra("backend", f"it needs {BACK_ENDS[name][0]}", "compiled")
    return name
