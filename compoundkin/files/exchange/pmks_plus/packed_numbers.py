"""Numbers, flags and check characters of share strings: base 64, three decimals, a leading 0 for a minus."""

from __future__ import annotations

import math
from collections.abc import Sequence

_DIGITS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-"
_VALUES = {digit: value for value, digit in enumerate(_DIGITS)}
# Check characters are the digits without the last two.
_CHECKS = _DIGITS[:62]
_PARTS = 1000
# The program's numbers are doubles: integers beyond this are not exact there either.
MOST = 2**53
# So many digits hold all integers up to that, the sign among them.
_LONGEST = 11
_FLAGS_IN_DIGIT = 6
# The hash of Fowler, Noll and Vo (1a, 32 bits), six digits of base 62, which links of late 2026 end with.
_FNV_START, _FNV_PRIME, _HASH_DIGITS = 0x811C9DC5, 0x01000193, 6


def packed_integer(value: int) -> str:
    """Return the digits of an integer.

    >>> packed_integer(1000), packed_integer(-1000), packed_integer(0)
    ('Fe', '0Fe', '0')
    """
    digits, rest = "", abs(value)
    while True:
        rest, digit = divmod(rest, 64)
        digits = _DIGITS[digit] + digits
        if not rest:
            return f"0{digits}" if value < 0 else digits


def packed_decimal(value: float) -> str:
    """Return the digits of a number, rounded to three decimals; halves go up.

    >>> packed_decimal(0.5), packed_decimal(-4.0), packed_decimal(1234.567)
    ('7q', '0_W', '4jQ7')
    """
    return packed_integer(math.floor(value * _PARTS + 0.5))


def unpacked_integer(text: str) -> int:
    """Return the integer that digits say. Raises ValueError where they say none."""
    if not text or len(text) > _LONGEST or any(digit not in _VALUES for digit in text):
        raise ValueError(text)
    value = 0
    for digit in text:
        value = value * 64 + _VALUES[digit]
    if value > MOST:
        raise ValueError(text)
    return -value if text[0] == "0" else value


def unpacked_decimal(text: str) -> float:
    """Return the number that digits say. Raises ValueError where they say none.

    >>> unpacked_decimal("Fd-"), unpacked_decimal("07q")
    (63.999, -0.5)
    """
    return unpacked_integer(text) / _PARTS


def packed_flags(flags: Sequence[bool]) -> str:
    """Return a digit for each six flags. The first flag is the lowest bit of the last digit.

    >>> packed_flags([1, 0, 0, 1, 1, 0, 0, 0]), packed_flags([0, 1, 1, 0, 0])
    ('0P', '6')
    """
    digits = -(-len(flags) // _FLAGS_IN_DIGIT)
    value = sum(1 << bit for bit, flag in enumerate(flags) if flag)
    return "".join(_DIGITS[value >> _FLAGS_IN_DIGIT * k & 63] for k in reversed(range(digits)))


def unpacked_flags(text: str, count: int) -> tuple[bool, ...]:
    """Return the flags that digits say. Raises ValueError where they say none.

    >>> unpacked_flags("f", 6)
    (True, False, False, True, False, True)
    """
    if not text or any(digit not in _VALUES for digit in text):
        raise ValueError(text)
    value = 0
    for digit in text[-2:]:
        value = value * 64 + _VALUES[digit]
    return tuple(bool(value >> bit & 1) for bit in range(count))


def check_character(text: str) -> str:
    """Return the character that a string of this length ends with. It counts as the browser does: UTF-16.

    >>> check_character("x" * 180)
    'u'
    """
    return _CHECKS[len(text.encode("utf-16-le", "surrogatepass")) // 2 % len(_CHECKS)]


def hash_of(text: str) -> str:
    """Return the hash that links of late 2026 end with, after a star.

    >>> hash_of("a")
    '4AvVxE'
    """
    value = _FNV_START
    units = memoryview(text.encode("utf-16-le", "surrogatepass")).cast("H")
    for unit in units:
        value = (value ^ unit) * _FNV_PRIME & 0xFFFFFFFF
    digits = ""
    for _ in range(_HASH_DIGITS):
        value, digit = divmod(value, len(_CHECKS))
        digits = _CHECKS[digit] + digits
    return digits
