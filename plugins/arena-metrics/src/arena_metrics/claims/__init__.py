"""Statements about planners, as data, and what runs say of them."""
