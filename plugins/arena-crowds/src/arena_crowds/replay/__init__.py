"""Recorded people, and bodies by timetables."""
