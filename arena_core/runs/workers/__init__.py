"""Processes that do jobs: supervised, with budgets, ended as a whole."""
