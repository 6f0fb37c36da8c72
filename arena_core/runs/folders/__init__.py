"""What a run leaves in its folder, and what is still to be done there."""
