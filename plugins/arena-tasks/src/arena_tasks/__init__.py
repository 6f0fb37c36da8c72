"""Task modes of the arena suite."""

from arena_core import Register, hookimpl


@hookimpl
def register_task_modes(register: Register) -> None:
    """Offer random problems, of a density, of a curriculum, with company, from a file, of BARN, and of teams."""
    register("random", "arena_tasks.random.random_task:RandomTask")
    register("density", "arena_tasks.random.density_task:DensityTask")
    register("staged", "arena_tasks.random.staged_task:StagedTask")
    register("company", "arena_tasks.random.company_task:CompanyTask")
    register("group", "arena_tasks.random.group_task:GroupTask")
    register("scenario", "arena_tasks.scenario_files.scenario_task:ScenarioTask")
    register("barn", "arena_tasks.random.barn_task:BarnTask")
    register("dynabarn", "arena_tasks.random.barn_task:BarnTask")
    register("antipodal", "arena_tasks.teams.antipodal_task:AntipodalTask")
    register("swap", "arena_tasks.teams.swap_task:SwapTask")
    register("patrol", "arena_tasks.teams.patrol_task:PatrolTask")
    register("delivery", "arena_tasks.teams.delivery_task:DeliveryTask")


@hookimpl
def register_patrol_strategies(register: Register) -> None:
    """Offer how robots patrol."""
    register("conscientious_reactive", "arena_tasks.teams.patrol_strategies:ConscientiousReactive")
    register("cyclic", "arena_tasks.teams.patrol_strategies:Cyclic")


@hookimpl
def register_commands(register: Register) -> None:
    """Offer work on scenario files."""
    register("scenario", "arena_tasks.commands.scenario_command:ScenarioCommand")


@hookimpl
def register_listings(register: Register) -> None:
    """Offer the scenarios of all packs."""
    register("scenarios", "arena_tasks.commands.scenario_listing:ScenarioListing")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_tasks.conf"
