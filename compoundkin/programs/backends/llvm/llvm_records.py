"""The arrays of a call, read from NumPy's own records: addresses and strides, and whether the code suits them.

A call hands over the arrays as objects. To ask each for its address in Python would take longer than to compute a
hundred poses.
"""

from __future__ import annotations

from compoundkin.programs.backends.llvm.llvm_control import ControlText
from compoundkin.programs.backends.llvm.llvm_plan import (
    ANY_STRIDE,
    ARRAY_KIND,
    COMPLEX,
    HEADER,
    NUMBER_KIND,
    SIDE_BY_SIDE,
    LanePlan,
)
from compoundkin.programs.graph.flat_program import BY_DESIGN, BY_POSE

# Where NumPy's record of an array has what (PyArrayObject_fields of its C interface, which it never changes).
KIND, DATA, DIMENSIONS, SHAPE, STRIDES, NUMBERS, FLAGS = 8, 16, 24, 32, 40, 56, 64
ALIGNED, WRITEABLE = 0x100, 0x400
HEAD = "define internal i1 @unpack(ptr %O, ptr %S, i64 %D, i64 %P) #0 {"
WANTED_STRIDE = {ANY_STRIDE: -1, SIDE_BY_SIDE: 8, COMPLEX: 16}


def lane_axis_of(stratum: int, axis: int) -> int:
    """Return the axis along which arrays are read in lanes, or 0."""
    return axis if stratum & axis else stratum & BY_POSE


def unpacking_text(plan: LanePlan) -> str:
    """Return the function that fills the table of arrays and checks them."""
    n = plan.arrays
    axes = [lane_axis_of(plan.stratum(k), plan.axis) for k in range(n)]
    wanted = [WANTED_STRIDE[kind] if axis else -1 for kind, axis in zip(plan.layout.kinds, axes, strict=True)]
    flags = [ALIGNED if k < len(plan.inputs) else ALIGNED | WRITEABLE for k in range(n)]
    tables = {"strata": [plan.stratum(k) for k in range(n)], "axes": axes, "wanted": wanted, "flags": flags}
    text = ControlText()
    with text.steps(0, n) as i:
        array = text.loaded("%O", i, "ptr")
        _expect(text, text.put(f"icmp eq i64 {_field(text, array, KIND)}, {text.loaded('%S', ARRAY_KIND)}"))
        _expect(text, _is_matrix_of_numbers(text, array, i))
        _expect(text, _is_of_shape(text, array, i))
    for one, other in plan.layout.pairs:
        _expect(text, _is_pair(text, one, other))
    rows = (
        f"@{name} = private constant [{n} x i64] [{', '.join(f'i64 {k}' for k in row)}]" for name, row in tables.items()
    )
    return "\n".join([*rows, HEAD, "entry:", *text.lines, "  ret i1 true", "bad:", "  ret i1 false", "}"])


def _expect(text: ControlText, truth: str) -> None:
    """Write that all is lost where something is not true."""
    name = f"good{truth.removeprefix('%')}"
    text.do(f"br i1 {truth}, label %{name}, label %bad")
    text.label(name)


def _field(text: ControlText, array: str, offset: int, kind: str = "i64") -> str:
    """Write the reading of a field of an array's record."""
    return text.put(f"load {kind}, ptr {text.put(f'getelementptr i8, ptr {array}, i64 {offset}')}")


def _all(text: ControlText, *truths: str) -> str:
    found = truths[0]
    for each in truths[1:]:
        found = text.put(f"and i1 {found}, {each}")
    return found


def _is_matrix_of_numbers(text: ControlText, array: str, i: str) -> str:
    """Write whether an array has two axes and holds numbers that can be read, or written."""
    needed = text.put(f"trunc i64 {text.loaded('@flags', i)} to i32")
    flags = text.put(f"and i32 {_field(text, array, FLAGS, 'i32')}, {needed}")
    return _all(
        text,
        text.put(f"icmp eq i32 {_field(text, array, DIMENSIONS, 'i32')}, 2"),
        text.put(f"icmp eq i64 {_field(text, array, NUMBERS)}, {text.loaded('%S', NUMBER_KIND)}"),
        text.put(f"icmp eq i32 {flags}, {needed}"),
    )


def _is_of_shape(text: ControlText, array: str, i: str) -> str:
    """Write an array's row of the table, and whether its shape and stride are as expected."""
    shape, strides = _field(text, array, SHAPE, "ptr"), _field(text, array, STRIDES, "ptr")
    row = text.words("%S", text.whole("add", text.whole("mul", i, 3), HEADER))
    text.do(f"store i64 {_field(text, array, DATA)}, ptr {row}")
    stratum, axis, wanted = (text.loaded(f"@{name}", i) for name in ("strata", "axes", "wanted"))
    truths = []
    any_stride = text.put(f"icmp eq i64 {wanted}, -1")
    for word, (bit, length) in enumerate(((BY_DESIGN, "%D"), (BY_POSE, "%P"))):
        here, stride = text.loaded(shape, word), text.loaded(strides, word)
        varies = text.put(f"icmp ne i64 {text.whole('and', stratum, bit)}, 0")
        truths.append(text.put(f"icmp eq i64 {here}, {text.put(f'select i1 {varies}, i64 {length}, i64 1')}"))
        one = text.put(f"icmp eq i64 {here}, 1")
        text.do(f"store i64 {text.put(f'select i1 {one}, i64 0, i64 {stride}')}, ptr {text.words(row, word + 1)}")
        fits = text.put(f"or i1 {one}, {text.put(f'icmp eq i64 {stride}, {wanted}')}")
        free = text.put(f"or i1 {any_stride}, {text.put(f'icmp ne i64 {axis}, {bit}')}")
        truths.append(text.put(f"or i1 {fits}, {free}"))
    return _all(text, *truths)


def _is_pair(text: ControlText, one: int, other: int) -> str:
    """Write whether two arrays are the parts of a complex one."""
    a, b = (text.words("%S", HEADER + 3 * array) for array in (one, other))
    behind = text.whole("add", text.loaded(a, 0), 8)
    truths = [text.put(f"icmp eq i64 {behind}, {text.loaded(b, 0)}")]
    truths += [text.put(f"icmp eq i64 {text.loaded(a, k)}, {text.loaded(b, k)}") for k in (1, 2)]
    return _all(text, *truths)
