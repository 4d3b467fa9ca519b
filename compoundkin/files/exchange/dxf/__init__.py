"""DXF files: a pose on layers, the contours of links with pin holes at true size, paths, profiles of cams."""
