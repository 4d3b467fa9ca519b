"""Work and power, masses in motion, and efforts without reactions."""
