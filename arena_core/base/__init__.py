"""What everything stands on: errors, limits, files, geometry of arrays, random streams, signals."""
