"""Where people will be, by the forces of the crowd."""
