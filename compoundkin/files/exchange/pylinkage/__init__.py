"""pylinkage: its JSON in and out, and its objects as they are."""
