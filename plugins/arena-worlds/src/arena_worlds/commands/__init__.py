"""`arena world`."""
