"""The configuration curve: the drivers' path, the configuration of every group along it, its change points."""
