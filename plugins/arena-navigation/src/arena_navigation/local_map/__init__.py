"""The rolling cost window, and the map of an unknown world."""
