"""Back ends: what computes a flat program; the first that is installed is taken."""
