"""Training world models; needs the extra ``arena-navrep[train]``."""
