"""The hooks that a plugin may implement: functions of its module that are marked with ``hookimpl``.

All but the last two are called once in each process, in the order of the plugins' names, and get ``register``. A plugin
that cannot be imported, misspells a hook or raises is a BrokenPlugin, named in one line with how to switch it off.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import pluggy

from arena_core.values.episode import EpisodeRecord

hookspec = pluggy.HookspecMarker("arena")
hookimpl = pluggy.HookimplMarker("arena")

Factory = Callable[..., Any] | str


class Register(Protocol):
    """What a ``register_*`` hook receives.

    ``factory`` is a class or a function, or a text ``"module:name"``, which is imported only when it is used: so
    ``arena list`` loads no deep-learning library.
    """

    def __call__(self, name: str, factory: Factory) -> None:
        """Offer ``factory`` under ``name``; raise DuplicateComponent where another plugin has offered it."""


@hookspec
def register_simulators(register: Register) -> None:
    """Offer simulators: ``simulator=NAME``.

    Called once in each process, when plugins are loaded. The factory is called once when a run is built: it gets
    ``robot: Robot``, ``pedestrians: PedestrianModel`` and the keys of its YAML, by keyword, and returns a
    ``Simulator``. It raises ConfigurationError for values that contradict each other; whatever else it raises is
    reported as BrokenPlugin.

    ```python
    @hookimpl
    def register_simulators(register: Register) -> None:
        # offers simulator=my_simulator
        register("my_simulator", "my_package.simulator:MySimulator")
    ```
    """


@hookspec
def register_robots(register: Register) -> None:
    """Offer robots: ``robot=NAME``.

    Called once in each process, when plugins are loaded. The factory is called once when a run is built: it gets the
    keys of its YAML, by keyword, and returns a ``Robot``. Mostly the factory is the core's own ``make_robot``: a robot
    is a YAML file. It raises ConfigurationError for values that contradict each other; whatever else it raises is
    reported as BrokenPlugin.

    ```python
    @hookimpl
    def register_robots(register: Register) -> None:
        # offers robot=my_robot
        register("my_robot", "arena_core:make_robot")
    ```
    """


@hookspec
def register_worlds(register: Register) -> None:
    """Offer sources of worlds: ``world=NAME``.

    Called once in each process, when plugins are loaded. The factory is called once when a run is built: it gets the
    keys of its YAML, by keyword, and returns a ``WorldSource``. It raises ConfigurationError for values that contradict
    each other; whatever else it raises is reported as BrokenPlugin.

    ```python
    @hookimpl
    def register_worlds(register: Register) -> None:
        # offers world=my_world
        register("my_world", "my_package.world:MyWorld")
    ```
    """


@hookspec
def register_pedestrian_models(register: Register) -> None:
    """Offer models of how people walk: ``pedestrians=NAME``.

    Called once in each process, when plugins are loaded. The factory is called once when a run is built, before the
    simulator: it gets the keys of its YAML, by keyword, and returns a ``PedestrianModel``. It raises ConfigurationError
    for values that contradict each other; whatever else it raises is reported as BrokenPlugin.

    ```python
    @hookimpl
    def register_pedestrian_models(register: Register) -> None:
        # offers pedestrians=my_crowd
        register("my_crowd", "my_package.crowd:MyCrowd")
    ```
    """


@hookspec
def register_task_modes(register: Register) -> None:
    """Offer sources of scenarios: ``task=NAME``.

    Called once in each process, when plugins are loaded. The factory is called once when a run is built: it gets
    ``robot: Robot``, ``world: WorldSource`` and the keys of its YAML, by keyword, and returns a ``TaskMode``. It raises
    ConfigurationError for values that contradict each other; whatever else it raises is reported as BrokenPlugin.

    ```python
    @hookimpl
    def register_task_modes(register: Register) -> None:
        # offers task=my_task
        register("my_task", "my_package.task:MyTask")
    ```
    """


@hookspec
def register_patrol_strategies(register: Register) -> None:
    """Offer what sends patrolling robots from place to place: ``patrol_strategy@task.strategy=NAME``.

    Called once in each process, when plugins are loaded. The factory is called once when a run of ``task=patrol`` is
    built: it gets the keys of its YAML, by keyword, and returns a ``PatrolStrategy``. It raises ConfigurationError for
    values that contradict each other; whatever else it raises is reported as BrokenPlugin.

    ```python
    @hookimpl
    def register_patrol_strategies(register: Register) -> None:
        # offers patrol_strategy@task.strategy=my_strategy
        register("my_strategy", "my_package.strategy:MyStrategy")
    ```
    """


@hookspec
def register_communications(register: Register) -> None:
    """Offer what carries messages between the robots of a team: ``communication=NAME``.

    Called once in each process, when plugins are loaded. The factory is called once when a run of a team is built: it
    gets the keys of its YAML, by keyword, and returns a ``Communication``. It raises ConfigurationError for values that
    contradict each other; whatever else it raises is reported as BrokenPlugin.

    ```python
    @hookimpl
    def register_communications(register: Register) -> None:
        # offers communication=my_radio
        register("my_radio", "my_package.radio:MyRadio")
    ```
    """


@hookspec
def register_localizers(register: Register) -> None:
    """Offer localisers: ``localizer=NAME``.

    Called once in each process, when plugins are loaded. The factory is called once when a run is built: it gets the
    keys of its YAML, by keyword, and returns a ``Localizer``. One whose constructor names ``robot: Robot`` is given it,
    too. It raises ConfigurationError for values that contradict each other; whatever else it raises is reported as
    BrokenPlugin.

    ```python
    @hookimpl
    def register_localizers(register: Register) -> None:
        # offers localizer=my_localizer
        register("my_localizer", "my_package.localizer:MyLocalizer")
    ```
    """


@hookspec
def register_global_planners(register: Register) -> None:
    """Offer global planners: ``global_planner=NAME``.

    Called once in each process, when plugins are loaded. The factory is called once when a run is built: it gets the
    keys of its YAML, by keyword, and returns a ``GlobalPlanner``. One whose constructor names ``robot: Robot`` is given
    it, too. It raises ConfigurationError for values that contradict each other; whatever else it raises is reported as
    BrokenPlugin.

    ```python
    @hookimpl
    def register_global_planners(register: Register) -> None:
        # offers global_planner=my_search
        register("my_search", "my_package.search:MySearch")
    ```
    """


@hookspec
def register_waypoint_generators(register: Register) -> None:
    """Offer waypoint generators: ``waypoints=NAME``.

    Called once in each process, when plugins are loaded. The factory is called once when a run is built: it gets the
    keys of its YAML, by keyword (and ``robot: Robot``, if its constructor names it), and returns a
    ``WaypointGenerator``. It raises ConfigurationError for values that contradict each other; whatever else it raises
    is reported as BrokenPlugin.

    ```python
    @hookimpl
    def register_waypoint_generators(register: Register) -> None:
        # offers waypoints=my_waypoints
        register("my_waypoints", "my_package.waypoints:MyWaypoints")
    ```
    """


@hookspec
def register_local_maps(register: Register) -> None:
    """Offer rolling cost grids around the robot: ``local_map=NAME``.

    Called once in each process, when plugins are loaded. The factory is called once when a run is built: it gets the
    keys of its YAML, by keyword, and returns a ``LocalMap``. One whose constructor names ``robot: Robot`` is given it,
    too. It raises ConfigurationError for values that contradict each other; whatever else it raises is reported as
    BrokenPlugin.

    ```python
    @hookimpl
    def register_local_maps(register: Register) -> None:
        # offers local_map=my_map
        register("my_map", "my_package.local_map:MyLocalMap")
    ```
    """


@hookspec
def register_trackers(register: Register) -> None:
    """Offer trackers of moving obstacles: ``tracker=NAME``.

    Called once in each process, when plugins are loaded. The factory is called once when a run is built: it gets the
    keys of its YAML, by keyword, and returns a ``Tracker``. One whose constructor names ``robot: Robot`` is given it,
    too. It raises ConfigurationError for values that contradict each other; whatever else it raises is reported as
    BrokenPlugin.

    ```python
    @hookimpl
    def register_trackers(register: Register) -> None:
        # offers tracker=my_tracker
        register("my_tracker", "my_package.tracker:MyTracker")
    ```
    """


@hookspec
def register_predictors(register: Register) -> None:
    """Offer predictors of moving obstacles: ``predictor=NAME``.

    Called once in each process, when plugins are loaded. The factory is called once when a run is built: it gets the
    keys of its YAML, by keyword, and returns a ``Predictor``. One whose constructor names ``robot: Robot`` is given it,
    too. It raises ConfigurationError for values that contradict each other; whatever else it raises is reported as
    BrokenPlugin.

    ```python
    @hookimpl
    def register_predictors(register: Register) -> None:
        # offers predictor=my_predictor
        register("my_predictor", "my_package.predictor:MyPredictor")
    ```
    """


@hookspec
def register_planners(register: Register) -> None:
    """Offer local planners: ``planner=NAME``.

    Called once in each process, when plugins are loaded. The factory is called once when a run is built, in every
    worker process: it gets ``robot: Robot`` and the keys of its YAML, by keyword, and returns a ``Planner``. It raises
    ConfigurationError for values that contradict each other; whatever else it raises is reported as BrokenPlugin.

    ```python
    @hookimpl
    def register_planners(register: Register) -> None:
        # offers planner=my_planner
        register("my_planner", "my_package.planner:MyPlanner")
    ```
    """


@hookspec
def register_metrics(register: Register) -> None:
    """Offer packs of metrics: ``metrics=[si,NAME]``.

    Called once in each process, when plugins are loaded. The factory is called once when a run is built, and by ``arena
    evaluate``: it gets the keys of its YAML, by keyword, and returns a ``MetricPack``. It raises ConfigurationError for
    values that contradict each other; whatever else it raises is reported as BrokenPlugin.

    ```python
    @hookimpl
    def register_metrics(register: Register) -> None:
        # offers the pack my_pack
        register("my_pack", "my_package.metrics:MyPack")
    ```
    """


@hookspec
def register_rewards(register: Register) -> None:
    """Offer rewards for training: ``reward=NAME``.

    Called once in each process, when plugins are loaded. The factory is called once when a training begins: it gets
    ``robot: Robot`` and the keys of its YAML, by keyword, and returns a ``Reward``. It raises ConfigurationError for
    values that contradict each other; whatever else it raises is reported as BrokenPlugin.

    ```python
    @hookimpl
    def register_rewards(register: Register) -> None:
        # offers reward=my_reward
        register("my_reward", "my_package.reward:MyReward")
    ```
    """


@hookspec
def register_observation_encoders(register: Register) -> None:
    """Offer observation encoders of learned planners: ``observation_encoder=NAME``.

    Called once in each process, when plugins are loaded. The factory is called when a training begins, and with each
    planner that runs a policy made with it: it gets ``robot: Robot`` and the keys of its YAML, by keyword, and returns
    an ``ObservationEncoder``. It raises ConfigurationError for values that contradict each other; whatever else it
    raises is reported as BrokenPlugin.

    ```python
    @hookimpl
    def register_observation_encoders(register: Register) -> None:
        # offers observation_encoder=my_encoder
        register("my_encoder", "my_package.encoder:MyEncoder")
    ```
    """


@hookspec
def register_policies(register: Register) -> None:
    """Offer trained policies of a learned planner, which may be another distribution's: ``PLANNER/RECIPE``.

    Called once in each process, when plugins are loaded. What is offered is no factory but the address of a folder,
    ``pkg://PACKAGE/FOLDER``, which holds ``ROBOT.onnx`` and its card ``ROBOT.json`` for each robot. ``planner=PLANNER``
    takes its policy from there where its ``policy`` is null and its ``recipe`` is RECIPE, and raises
    ConfigurationError where the folder has none for the robot.

    ```python
    @hookimpl
    def register_policies(register: Register) -> None:
        # offers my_planner/my_recipe
        register("my_planner/my_recipe", "pkg://my_package/policies")
    ```
    """


@hookspec
def register_trainers(register: Register) -> None:
    """Offer ways in which ``arena train`` trains a planner: ``trainer.name: NAME in a recipe``.

    Called once in each process, when plugins are loaded. The factory is called once by ``arena train``: it gets the
    keys of its YAML, by keyword, and returns a ``Trainer``. It raises ConfigurationError for values that contradict
    each other; whatever else it raises is reported as BrokenPlugin.

    ```python
    @hookimpl
    def register_trainers(register: Register) -> None:
        # offers the trainer my_trainer
        register("my_trainer", "my_package.trainer:MyTrainer")
    ```
    """


@hookspec
def register_executors(register: Register) -> None:
    """Offer ways to run many episodes: ``executor=NAME``.

    Called once in each process, when plugins are loaded. The factory is called once by ``arena run``, in the main
    process: it gets the keys of its YAML, by keyword, and returns an ``Executor``. It raises ConfigurationError for
    values that contradict each other; whatever else it raises is reported as BrokenPlugin.

    ```python
    @hookimpl
    def register_executors(register: Register) -> None:
        # offers executor=my_cluster
        register("my_cluster", "my_package.cluster:MyExecutor")
    ```
    """


@hookspec
def register_commands(register: Register) -> None:
    """Offer subcommands: ``arena NAME``.

    Called once in each process, when plugins are loaded. The factory is called without arguments when the command is
    called, and for ``arena --help``, and returns a ``Command``. Its class attribute ``help`` is a line of ``arena
    --help``. An ArenaError of it is printed as one line.

    ```python
    @hookimpl
    def register_commands(register: Register) -> None:
        # offers my_command
        register("my_command", "my_package.command:MyCommand")
    ```
    """


@hookspec
def register_listings(register: Register) -> None:
    """Offer further things that ``arena list`` shows: ``arena list NAME``.

    Called once in each process, when plugins are loaded. The factory is called without arguments by ``arena list``, and
    returns a ``Listing``. An ArenaError of it is printed as one line.

    ```python
    @hookimpl
    def register_listings(register: Register) -> None:
        # offers my_maps
        register("my_maps", "my_package.maps:MapListing")
    ```
    """


@hookspec
def register_reporters(register: Register) -> None:
    """Offer what makes reports of runs; the first one installed serves ``arena run`` and ``Runs.report``.

    Called once in each process, when plugins are loaded. The factory is called without arguments at the end of a run,
    and returns a ``Reporter``. An ArenaError of it is printed as one line.

    ```python
    @hookimpl
    def register_reporters(register: Register) -> None:
        # offers my_report
        register("my_report", "my_package.report:MyReport")
    ```
    """


@hookspec
def register_exports(register: Register) -> None:
    """Offer forms in which other programs read records: ``arena export RUN to=NAME``.

    Called once in each process, when plugins are loaded. The factory is called without arguments by ``arena export``,
    and returns an ``Export``. An ArenaError of it is printed as one line.

    ```python
    @hookimpl
    def register_exports(register: Register) -> None:
        # offers the form my_form
        register("my_form", "my_package.form:MyForm")
    ```
    """


@hookspec
def register_references(register: Register) -> None:
    """Offer what finds out afterwards what could have been done in the problems of a run: ``reference=NAME``.

    Called once in each process, when plugins are loaded. The factory is called once by ``arena run``, in the main
    process: it gets the keys of its YAML, by keyword, and returns a ``Reference``. It raises ConfigurationError for
    values that contradict each other; whatever else it raises is reported as BrokenPlugin.

    ```python
    @hookimpl
    def register_references(register: Register) -> None:
        # offers reference=my_reference
        register("my_reference", "my_package.reference:MyReference")
    ```
    """


@hookspec
def config_package() -> str:  # type: ignore[empty-body]
    """Return the package that holds this plugin's configuration groups.

    Called when a configuration is composed or listed. Its folders are groups, ``planner/my_planner.yaml`` is the option
    ``planner=my_planner``; it needs an ``__init__.py``. A package that cannot be imported is a BrokenPlugin.

    ```python
    @hookimpl
    def config_package() -> str:
        # where the options lie
        return "my_package.conf"
    ```
    """


@hookspec
def episode_finished(record: EpisodeRecord) -> None:
    """Hear of a finished episode, after its record was written.

    Called in the process that ran it: in any worker, and in several at a time. Nothing is returned. An exception ends
    the job, which then counts as failed: catch what may go wrong.

    ```python
    @hookimpl
    def episode_finished(record: EpisodeRecord) -> None:
        # how it ended
        print(record.meta["columns"]["episode"], record.meta["outcome"])
    ```
    """
