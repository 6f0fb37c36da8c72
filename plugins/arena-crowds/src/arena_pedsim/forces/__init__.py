"""Bodies and forces: the compiled step."""
