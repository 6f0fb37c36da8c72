"""What learns, is tuned or climbs a ladder: its folders in a project, and what stands in them."""
