"""Metric packs and the report of the arena suite."""

from arena_core import Register, hookimpl


@hookimpl
def register_metrics(register: Register) -> None:
    """Offer metrics in SI units, the score of the BARN challenge, how it was for people, their ratings, and teams."""
    register("si", "arena_metrics.packs.si:SiMetrics")
    register("barn", "arena_metrics.packs.barn:BarnMetrics")
    register("social", "arena_metrics.packs.social:SocialMetrics")
    register("company", "arena_metrics.packs.company:CompanyMetrics")
    register("human", "arena_metrics.packs.human:HumanMetrics")
    register("team", "arena_metrics.packs.team:TeamMetrics")
    register("survey", "arena_metrics.packs.survey:SurveyMetrics")


@hookimpl
def register_commands(register: Register) -> None:
    """Offer ``arena report``, ``query``, ``iso18646`` and ``compare-real``."""
    register("report", "arena_metrics.pages.report:ReportCommand")
    register("query", "arena_metrics.tables.query:QueryCommand")
    register("iso18646", "arena_metrics.tables.iso18646:Iso18646Command")
    register("compare-real", "arena_metrics.pages.sim_to_real:CompareRealCommand")


@hookimpl
def register_reporters(register: Register) -> None:
    """Offer the report."""
    register("report", "arena_metrics.pages.report:Report")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_metrics.conf"
