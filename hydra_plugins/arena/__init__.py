"""The core's Hydra plugins: where configuration is found, and how the jobs of a multirun are launched."""
