"""The kinds of inputs of a program."""

# a dimension of a link or pair, a driver's value or rate, what is found outside the program, a number of an objective
DIMENSION, DRIVE, SEED, PARAMETER = "dimension", "drive", "seed", "parameter"

# Parts of seeds: the sign of a group's mode, the angle of a link with full turns.
SIGN, TURNS = "sign", "turns"


def group_seed(index: int) -> str:
    """Return what the seeds of a group are called.

    >>> group_seed(2)
    'group 2'
    """
    return f"group {index}"
