"""The operations of programs as LLVM's instructions, one entry each, and functions of lanes as polynomials.

Sine, cosine, arctangent, exponential and logarithm are polynomials after an exact reduction. Sources: fdlibm (Sun
Microsystems, 1993) for the parts of pi/2 and ln 2 and for the polynomials of sin, cos and log.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from compoundkin.programs.backends.llvm_text import LaneText


def _extreme(how: str, keeps_none: bool) -> Callable[..., str]:
    """Return what writes the greater or the lesser of two; where either is no number, that or the other one."""

    def written(text: LaneText, a: str, b: str) -> str:
        found, doubtful = text.select(text.compare(how, a, b), a, b), a if keeps_none else b
        return text.select(text.compare("uno", doubtful, doubtful), a, found)

    return written


lesser, _greater = _extreme("olt", True), _extreme("ogt", True)


_lesser_number, _greater_number = _extreme("olt", False), _extreme("ogt", False)


def _two(instruction: str) -> Callable[..., str]:
    return lambda text, a, b: text.two(instruction, a, b)


def _call(function: str) -> Callable[..., str]:
    return lambda text, a: text.call(function, a)


def _compare(how: str) -> Callable[..., str]:
    return lambda text, a, b: text.compare(how, a, b)


# Adding it rounds to a whole number, which then stands in the lowest bits.
MAGIC = 1.5 * 2.0**52


# (atan(t) / t - 1) / t^2 over t^2, through Chebyshev's points up to tan(pi/8)^2; relative error of the whole 7e-18
ARCTANGENT = (
    -0.3333333333333333, 0.1999999999999552, -0.14285714284666542, 0.11111111015256361, -0.09090904578123903,
    0.07692183190826087, -0.06664511447381948, 0.0585814891280221, -0.0508544973794026, 0.03923165829558719,
    -0.01917688711906226,
)  # fmt: skip


# What the doubles nearest to the quarters of pi leave, by their numbers of quarters.
QUARTERS = {0: 0.0, 1: 3.061616997868383e-17, 2: 6.123233995736766e-17, 3: 9.184850993605148e-17,
            4: 1.2246467991473532e-16}  # fmt: skip


LN2 = (6.93147180369123816490e-01, 1.90821492927058770002e-10)


LOGARITHM = (
    6.666666666666735130e-01, 3.999999999940941908e-01, 2.857142874366239149e-01, 2.222219843214978396e-01,
    1.818357216161805012e-01, 1.531383769920937332e-01, 1.479819860511658591e-01,
)  # fmt: skip


HALF_ROOT = 0x3FE6A09E667F3BCD  # bits of sqrt(1/2)


EXPONENT_OF_ONE, SIGN = 0x3FF0000000000000, -(1 << 63)


def arctangent(text: LaneText, y: str, x: str) -> str:
    """Write the angle of the direction (x, y)."""
    steep, small, large = _ordered(text, y, x)
    folded = text.compare("ogt", small, text.two("fmul", large, text.number(math.tan(math.pi / 8))))
    above = text.select(folded, text.exact("fsub", small, large), small)
    below = text.select(folded, text.exact("fadd", small, large), large)
    t = text.exact("fdiv", above, below)
    z = text.exact("fmul", t, t)
    angle = text.fma(text.exact("fmul", t, z), text.horner(z, ARCTANGENT), t)
    behind = text.put(f"icmp slt {text.whole} {text.bits(x)}, {text.integer(0)}")
    turned = text.truths("xor", steep, behind)
    angle = text.select(turned, text.put(f"fneg {text.real} {angle}"), angle)
    base, rest = (_quarters(text, folded, steep, behind, part) for part in (lambda n: n * math.pi / 4, QUARTERS.get))
    angle = text.call("copysign", text.exact("fadd", base, text.exact("fadd", rest, angle)), y)
    return text.select(text.compare("uno", x, y), text.number(math.nan), angle)


def _ordered(text: LaneText, y: str, x: str) -> tuple[str, str, str]:
    """Write whether |y| is larger than |x|, and both by size, such that they can be added and divided."""
    ax, ay, one, infinite = text.call("fabs", x), text.call("fabs", y), text.number(1.0), text.number(math.inf)
    steep = text.compare("ogt", ay, ax)
    small, large = text.select(steep, ax, ay), text.select(steep, ay, ax)
    both, any_ = text.compare("oeq", small, infinite), text.compare("oeq", large, infinite)
    small = text.select(any_, text.select(both, one, text.number(0.0)), small)
    large = text.select(text.truths("or", any_, text.compare("oeq", large, text.number(0.0))), one, large)
    scale = text.select(text.compare("ogt", large, text.number(2.0**1000)), text.number(0.25), one)
    return steep, text.exact("fmul", small, scale), text.exact("fmul", large, scale)


def _quarters(text: LaneText, folded: str, steep: str, behind: str, part: object) -> str:
    """Write the angle that an octant starts from: a number of quarters of pi."""
    zero, one, two, three, four = (text.number(part(n)) for n in range(5))  # type: ignore[operator]
    inner = text.select(behind, three, one)
    return text.select(folded, inner, text.select(steep, two, text.select(behind, four, zero)))


def exponential(text: LaneText, x: str) -> str:
    """Write the exponential function: a power of two, in two factors, times a series."""
    for how, bound in (("ogt", 710.0), ("olt", -750.0)):
        x = text.select(text.compare(how, x, text.number(bound)), text.number(bound), x)
    magic = text.number(MAGIC)
    power = text.exact("fsub", text.fma(x, text.number(1.0 / math.log(2.0)), magic), magic)
    rest = x
    for part in LN2:
        rest = text.fma(power, text.number(-part), rest)
    series = text.horner(rest, [1.0 / math.factorial(n) for n in range(2, 14)])
    found = text.fma(text.exact("fmul", rest, rest), series, rest)
    found = text.exact("fadd", found, text.number(1.0))
    halved = text.fma(power, text.number(0.5), magic)
    others = text.exact("fadd", text.exact("fsub", power, text.exact("fsub", halved, magic)), magic)
    for half in (halved, others):
        scale = text.bitwise("shl", text.bitwise("add", text.bits(half), text.integer(1023)), text.integer(52))
        found = text.exact("fmul", found, text.from_bits(scale))
    return found


def logarithm(text: LaneText, x: str) -> str:
    """Write the natural logarithm. It is a multiple of ln 2 and a series in f / (2 + f)."""
    tiny = text.compare("olt", x, text.number(2.0**-1022))
    scaled = text.select(tiny, text.exact("fmul", x, text.number(2.0**54)), x)
    moved = text.bitwise("add", text.bits(scaled), text.integer(EXPONENT_OF_ONE - HALF_ROOT))
    # as whole number and number at once: below 2^52 the lowest bits of 2^52 + n are n
    shifted = text.bitwise("or", text.bitwise("lshr", moved, text.integer(52)), text.integer(0x4330000000000000))
    offset = text.select(tiny, text.number(2.0**52 + 1023 + 54), text.number(2.0**52 + 1023))
    k = text.exact("fsub", text.from_bits(shifted), offset)
    mantissa = text.bitwise("and", moved, text.integer((1 << 52) - 1))
    f = text.from_bits(text.bitwise("add", mantissa, text.integer(HALF_ROOT)))
    f = text.exact("fsub", f, text.number(1.0))
    s = text.exact("fdiv", f, text.exact("fadd", f, text.number(2.0)))
    z = text.exact("fmul", s, s)
    series = text.exact("fmul", z, text.horner(z, LOGARITHM))
    half = text.exact("fmul", text.number(0.5), text.exact("fmul", f, f))
    inner = text.fma(s, text.exact("fadd", half, series), text.exact("fmul", k, text.number(LN2[1])))
    found = text.exact("fsub", text.exact("fsub", half, inner), f)
    return _of_all_numbers(text, x, text.exact("fsub", text.exact("fmul", k, text.number(LN2[0])), found))


def _of_all_numbers(text: LaneText, x: str, found: str) -> str:
    """Write a logarithm, of zero, infinity and what has none too."""
    zero, infinite = text.number(0.0), text.number(math.inf)
    found = text.select(text.compare("oeq", x, infinite), infinite, found)
    found = text.select(text.compare("oeq", x, zero), text.number(-math.inf), found)
    return text.select(text.compare("ult", x, zero), text.number(math.nan), found)


# What is written for an operation, by its name; `sin` and `cos` are written by the section, which shares reductions.
INSTRUCTIONS: dict[str, Callable[..., str]] = {
    "add": _two("fadd"),
    "sub": _two("fsub"),
    "mul": _two("fmul"),
    "neg": lambda text, a: text.put(f"fneg {text.real} {a}"),
    "inv": lambda text, a: text.exact("fdiv", text.number(1.0), a),
    "sqrt": _call("sqrt"),
    "abs": _call("fabs"),
    "atan2": arctangent,
    "exp": exponential,
    "log": logarithm,
    "max": _greater,
    "min": lesser,
    "fmax": _greater_number,
    "fmin": _lesser_number,
    "floor": _call("floor"),
    "ceil": _call("ceil"),
    "rint": _call("rint"),
    "ge": _compare("oge"),
    "gt": _compare("ogt"),
    "eq": _compare("oeq"),
    "and": lambda text, a, b: text.truths("and", a, b),
    "or": lambda text, a, b: text.truths("or", a, b),
    "not": lambda text, a: text.put(f"xor {text.truth} {a}, {'true' if text.lanes == 1 else 'splat (i1 true)'}"),
    "select": lambda text, truth, one, other: text.select(truth, one, other),
}


# Which operands are truths: all of these, and the first of a choice.
ON_TRUTHS = {"and", "or", "not"}


# pi/2 in three parts; with so few bits in the first two that products with numbers of turns are exact.
HALF_PI = (1.57079632673412561417, 6.07710050630396597660e-11, 2.02226624879595063154e-21)


# Angles up to which that holds: a product rounded once has 20 bits more.
LARGEST_ANGLE, LARGEST_WITHOUT_FMA = 1e9, 1e6


SINE = (
    -1.66666666666666324348e-01, 8.33333333332248946124e-03, -1.98412698298579493134e-04,
    2.75573137070700676789e-06, -2.50507602534068634195e-08, 1.58969099521155010221e-10,
)  # fmt: skip


COSINE = (
    4.16666666666666019037e-02, -1.38888888888741095749e-03, 2.48015872894767294178e-05,
    -2.75573143513906633035e-07, 2.08757232129817482790e-09, -1.13596475577881948265e-11,
)  # fmt: skip


def quarter_turns(text: LaneText, x: str) -> tuple[str, str]:
    """Write an angle's remainder within an eighth of a turn, and the quarter turns."""
    magic = text.number(MAGIC)
    shifted = text.fma(x, text.number(2.0 / math.pi), magic)
    turns, rest = text.exact("fsub", shifted, magic), x
    for part in HALF_PI:
        rest = text.fma(turns, text.number(-part), rest)
    return rest, text.bits(shifted)


def sine_and_cosine(text: LaneText, rest: str, quarters: str) -> tuple[str, str]:
    """Write sine and cosine of an angle that is reduced."""
    z = text.exact("fmul", rest, rest)
    s = text.fma(text.exact("fmul", rest, z), text.horner(z, SINE), rest)
    c = text.fma(z, text.number(-0.5), text.number(1.0))
    c = text.fma(text.exact("fmul", z, z), text.horner(z, COSINE), c)
    odd = text.put(f"trunc {text.whole} {quarters} to {text.truth}")
    next_quarter = text.bitwise("add", quarters, text.integer(1))
    return (
        _with_sign(text, text.select(odd, c, s), quarters),
        _with_sign(text, text.select(odd, s, c), next_quarter),
    )


def _with_sign(text: LaneText, value: str, quarters: str) -> str:
    """Turn the sign of a value where the second bit of a number of quarter turns stands."""
    bit = text.bitwise("and", text.bitwise("shl", quarters, text.integer(62)), text.integer(SIGN))
    return text.from_bits(text.bitwise("xor", text.bits(value), bit))


def beyond_reduction(text: LaneText, x: str) -> str:
    """Write whether an angle is too large to be reduced here, but a number."""
    size, limit = text.call("fabs", x), LARGEST_ANGLE if text.has_fma else LARGEST_WITHOUT_FMA
    large = text.compare("ogt", size, text.number(limit))
    return text.truths("and", large, text.compare("one", size, text.number(math.inf)))
