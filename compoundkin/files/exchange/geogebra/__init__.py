"""Files of GeoGebra: a construction that can be dragged, as commands and as .ggb."""
