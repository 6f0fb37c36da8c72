"""Configuration of the learned predictor."""
