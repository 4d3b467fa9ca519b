"""Studies of many designs: what dimensions do to figures, tolerances, better dimensions."""
