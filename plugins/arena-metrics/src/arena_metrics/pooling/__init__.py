"""Episodes of many runs: read, pooled, sorted into cells, summed up."""
