"""`arena crowd`: people against recordings and the literature."""
