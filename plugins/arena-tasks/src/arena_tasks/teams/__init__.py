"""Tasks of several robots in one world."""
