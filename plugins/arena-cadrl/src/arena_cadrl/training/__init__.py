"""Training value networks; needs the extra ``arena-cadrl[train]``."""
