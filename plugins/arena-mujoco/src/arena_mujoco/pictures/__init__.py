"""Pictures and films of recorded episodes in 3-D, of either simulator."""
