"""Many episodes: benchmarks, workers and their budgets, folders, resuming, tables, progress."""
