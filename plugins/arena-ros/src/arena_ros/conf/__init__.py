"""The configuration of this package."""
