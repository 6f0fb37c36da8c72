"""Configuration of AIO."""
