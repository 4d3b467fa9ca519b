"""`.linkage2`, the files of the Linkage program: read, and written."""
