"""Worlds that are made here."""
