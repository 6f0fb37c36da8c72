"""Metric packs and the report of the arena suite."""

from arena_core import Register, hookimpl


@hookimpl
def register_metrics(register: Register) -> None:
    """Offer metrics in SI units, those of the original release, and the score of the BARN challenge."""
    register("si", "arena_metrics.packs.si:SiMetrics")
    register("barn", "arena_metrics.packs.barn:BarnMetrics")


@hookimpl
def register_commands(register: Register) -> None:
    """Offer ``arena report``, ``arena query`` and ``arena compare-real``."""
    register("report", "arena_metrics.pages.report:ReportCommand")
    register("query", "arena_metrics.tables.query:QueryCommand")
    register("compare-real", "arena_metrics.pages.sim_to_real:CompareRealCommand")


@hookimpl
def register_reporters(register: Register) -> None:
    """Offer the report."""
    register("report", "arena_metrics.pages.report:Report")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_metrics.conf"
