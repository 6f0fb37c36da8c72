"""Configuration of GRING."""
