"""`arena scenario`, and what `arena list` shows of packs."""
