"""Robots and planners that are there now: driving one, being one, asking one, and the relay that stops one."""
