"""The pack ``francis2023``: the scenario cards of Francis et al. 2023, drawn from few numbers."""
