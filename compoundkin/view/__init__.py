"""What people see: sketches, plots, animations, pages, reports, notebooks."""
