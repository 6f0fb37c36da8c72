"""People as ORCA agents."""
