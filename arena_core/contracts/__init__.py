"""What plugins implement: interfaces, what learning shares, hook specifications."""
