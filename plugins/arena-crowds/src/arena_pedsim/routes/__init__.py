"""Where people walk: waypoints, ways round walls."""
