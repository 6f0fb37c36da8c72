"""Presets, recipes, experiments and claims of the paper and the release."""
