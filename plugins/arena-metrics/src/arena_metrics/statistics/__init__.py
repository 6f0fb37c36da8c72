"""Intervals, tests and distances; they know nothing of runs."""
