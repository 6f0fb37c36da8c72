"""What repeats Arena-Bench, its paper and its release: presets, policies, metrics, claims and experiments."""

from arena_core import Register, hookimpl

RECIPES = ("aio/aio_as_released", "gring/gring_as_released", "navrep/navrep_as_released", "rosnav/rosnav_as_paper")


@hookimpl
def register_metrics(register: Register) -> None:
    """Offer the figures of the original evaluation scripts."""
    register("paper_legacy", "arena_replication.paper_legacy:PaperLegacyMetrics")


@hookimpl
def register_policies(register: Register) -> None:
    """Offer policies trained as those of the paper and the release were."""
    for name in RECIPES:
        register(name, f"pkg://arena_replication/policies/{name.partition('/')[2]}")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_replication.conf"
