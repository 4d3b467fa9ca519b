"""Making mechanisms: chains and their names, the composer, choices of frame and driver, inversion."""
