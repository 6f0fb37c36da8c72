"""Configuration of ROSNAV."""
