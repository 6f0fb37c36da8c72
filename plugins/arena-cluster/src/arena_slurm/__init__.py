"""Episodes as jobs of Slurm. submitit is imported when a run begins."""

from arena_core import Register, hookimpl


@hookimpl
def register_executors(register: Register) -> None:
    """Offer the jobs of a Slurm site."""
    register("slurm", "arena_slurm.executor:SlurmExecutor")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_slurm.conf"
