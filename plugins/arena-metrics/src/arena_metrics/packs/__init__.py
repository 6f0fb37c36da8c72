"""What metrics compute from one record: the packs, and what they share."""
