"""What carries messages between the robots of a team."""
