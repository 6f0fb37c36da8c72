"""Training policies by reinforcement learning; needs the extra ``arena-gym[train]``."""
