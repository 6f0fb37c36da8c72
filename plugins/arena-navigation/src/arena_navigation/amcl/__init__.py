"""Adaptive Monte Carlo localisation."""
