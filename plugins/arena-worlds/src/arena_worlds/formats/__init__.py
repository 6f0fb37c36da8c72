"""Worlds from files, and back."""
