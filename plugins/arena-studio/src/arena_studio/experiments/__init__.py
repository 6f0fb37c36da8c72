"""Experiments: composed, started, watched, stopped and resumed."""
