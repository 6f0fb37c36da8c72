"""How predictor=learned is trained: drives, samples, a fit."""
