"""The figures engineers ask of a motion: types of linkages, features of coupler curves, dwells, strokes, advantage."""
