"""pyslvs and Pyslvs-UI: expressions of mechanisms and project files."""
