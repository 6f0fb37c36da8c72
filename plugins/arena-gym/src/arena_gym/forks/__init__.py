"""How a switch is trained with forks: what each member would have made of the same states, and a fit to that."""
