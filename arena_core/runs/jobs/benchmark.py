"""A benchmark: one composed configuration, built into task, simulator and navigator."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from copy import deepcopy
from dataclasses import dataclass, replace
from hashlib import blake2b
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np

from arena_core.base.errors import ConfigurationError
from arena_core.base.folders import check_writable
from arena_core.base.hints import did_you_mean
from arena_core.base.pulse import pulse
from arena_core.base.stopwatch import Stopwatch
from arena_core.config.binding import read_settings
from arena_core.config.configuration import to_plain
from arena_core.config.privileged import PrivilegedPart, privileged_names, watch_privileged
from arena_core.config.registry import Registry
from arena_core.contracts.communication import Communication
from arena_core.contracts.navigation import Localizer
from arena_core.contracts.running import Metric, MetricPack
from arena_core.contracts.simulation import Simulator, TaskMode
from arena_core.loop import warm_up
from arena_core.loop.execution import Timing, run_episode
from arena_core.loop.guide import Guide, GuideParts, ReplanRules
from arena_core.loop.live import LiveFile
from arena_core.loop.navigator import Navigator
from arena_core.loop.record_arrays import whole_timing
from arena_core.loop.record_files import write_grid
from arena_core.loop.recording import Recorder, RecordingSettings
from arena_core.loop.recovery import RecoveryRules
from arena_core.loop.team_execution import TeamRules, TeamSeat, run_team
from arena_core.runs.jobs.code_digest import Code, digest_code
from arena_core.runs.jobs.teammates import Builders, Teammates, check_runs_teams, check_team
from arena_core.values.episode import EpisodeRecord, Scenario
from arena_core.values.parameters import Bounds, Episodes, NonNegativeInt
from arena_core.values.robot import Robot
from arena_core.values.world import free_area

PassageMargin = Annotated[float, Bounds(low=0.0, high=10.0)]  # m
Period = Annotated[float, Bounds(above=0.0, high=10.0)]  # s; a robot that decides less often drives blindly
LED_BY = ("localizer", "global_planner", "waypoints", "local_map", "tracker")
BRAIN = (*LED_BY, "predictor")
STRAIGHT = {"name": "constant_velocity"}  # the predictor of configurations that are older than predictors
NEEDED = (
    "robot",
    "world",
    "task",
    "pedestrians",
    "simulator",
    *LED_BY,
    "planner",
    "executor",
    "replan",
    "recoveries",
    "timing",
    "recording",
)
NOT_PART_OF_A_CELL = (
    "seed",
    "episodes",
    "executor",
    "resume",
    "report",
    "reference",
    "objective",
    "metrics",
    "recording",
    "experiment",
    "choices",
    "code",
    "privileged",
)


@dataclass(frozen=True, slots=True)
class RunSettings:
    """The run's own settings, outside every component.

    ``resume`` may also be ``force``: with other code than that of what is there. ``objective`` is what a sweeper asks
    for.
    """

    episodes: Episodes
    seed: NonNegativeInt
    resume: Literal[True, False, "force"]
    report: bool
    stop_on_collision: bool
    objective: str | list[str] | None


@dataclass(frozen=True, slots=True, eq=False)
class Benchmark:
    """Everything that runs the episodes of one cell; ``privileged`` names what of it sees the truth."""

    config: Mapping[str, Any]
    settings: RunSettings
    robot: Robot
    task: TaskMode
    simulator: Simulator
    navigator: Navigator
    timing: Timing
    metrics: Mapping[str, list[Metric]]
    recording: RecordingSettings
    code: Code
    privileged: tuple[str, ...] = ()
    mates: Teammates | None = None
    communication: Communication | None = None

    @property
    def robots(self) -> int:
        """Return how many robots each scenario has."""
        return self.task.robots()

    @property
    def columns(self) -> dict[str, Any]:
        """Return the columns of episodes.csv that the configuration alone decides."""
        return identity_columns({**self.config, "privileged": self.privileged}) | {"code": self.code.digest}

    def warm_up(self, *, tracks: bool = False) -> None:
        """Have what guides the robot and decides for it compiled in this process, with ``tracks`` also what follows
        people; what is wrong with it is left to the first step to tell.
        """
        known = self.config["world"].get("known") is not False
        with suppress(Exception, SystemExit):
            warm_up.warm_up(self.navigator, known=known, tracks=tracks)

    def run(self, episode: int, folder: Path, stage: int | None = None) -> EpisodeRecord:
        """Run one episode, on level ``stage`` of a task that adapts; its map is written to ``folder`` once."""
        watch, kernels = Stopwatch(), pulse.compiled()
        record = watch.timed("episode", lambda: self._run_episode(episode, folder, stage))
        whole = whole_timing(watch.spent["episode"], compiled=pulse.compiled() > kernels)
        return replace(record, timing={**record.timing, **whole})

    def run_all(self, episode: int, folder: Path, stage: int | None = None) -> dict[int, EpisodeRecord]:
        """Run one episode, or the episodes of its whole team, and return their records by episode."""
        if self.robots == 1:
            return {episode: self.run(episode, folder, stage)}
        assert self.mates is not None
        watch, kernels = Stopwatch(), pulse.compiled()
        records = watch.timed("episode", lambda: self._run_team(episode // self.robots, folder))
        whole = whole_timing(watch.spent["episode"], compiled=pulse.compiled() > kernels)
        return {number: replace(one, timing={**one.timing, **whole}) for number, one in records.items()}

    def _run_team(self, number: int, folder: Path) -> dict[int, EpisodeRecord]:
        """Run scenario ``number`` with its team."""
        assert self.mates is not None
        scenario = self.task.scenario(self.settings.seed, number)
        check_team(scenario, self.robots)
        scenario, first = self.mates.equip(scenario), number * self.robots
        configs = [self.config, *(self.mates.config(mate.planner, mate.robot) for mate in scenario.team)]
        navigators = [self.navigator, *self.mates.navigators(scenario)]
        seats = []
        for member, (config, navigator) in enumerate(zip(configs, navigators, strict=True)):
            told = {**config, "privileged": sorted({*self.privileged, *self.mates.privileged})}  # of any of them
            columns = identity_columns(told) | {"code": self.code.digest, "member": member}
            meta = self._meta(scenario, first + member, scenario.stage, folder) | {"config": cell_config(config)}
            meta["columns"] |= columns
            own, robot = scenario.seen_by(member), navigator.robot
            recorder = Recorder(own, robot, meta, self.recording)
            live = self._live(folder, own, robot, meta)
            seats.append(TeamSeat(navigator, recorder, str(columns["preset"]), live))
        rules = TeamRules(self.timing, self.settings.stop_on_collision, self.communication)
        records = run_team(scenario, self.simulator, seats, rules)
        return {first + member: _count_people(record) for member, record in enumerate(records)}

    def _meta(self, scenario: Scenario, episode: int, stage: int | None, folder: Path) -> dict[str, Any]:
        """Return what identifies an episode in its record; its map is written to ``folder``."""
        columns = self.columns | {
            "scenario": scenario.name,
            "scenario_hash": scenario.content_hash,
            "stage": stage,
            "episode": episode,
            "seed": self.settings.seed,
        }
        grid = scenario.world.grid
        with check_writable(folder):
            world = {"name": scenario.world.name, "known": scenario.world.known, "grid": write_grid(folder, grid)}
        world["free_area"] = grid.derive(free_area)
        return {"columns": columns, "world": world, "config": cell_config(self.config)}

    def _live(self, folder: Path, scenario: Scenario, robot: Robot, meta: Mapping[str, Any]) -> LiveFile | None:
        if not self.recording.live:
            return None
        return LiveFile(folder, meta["columns"]["episode"], scenario, robot, str(meta["world"]["grid"]))

    def _run_episode(self, episode: int, folder: Path, stage: int | None) -> EpisodeRecord:
        task = self.task if stage is None else self.task.at_stage(stage)
        scenario = task.scenario(self.settings.seed, episode)
        meta = self._meta(scenario, episode, scenario.stage if stage is None else stage, folder)
        recorder = Recorder(scenario, self.robot, meta, self.recording)
        live = self._live(folder, scenario, self.robot, meta)
        record = run_episode(
            scenario,
            self.simulator,
            self.navigator,
            self.timing,
            recorder,
            live,
            stop_on_collision=self.settings.stop_on_collision,
        )
        return _count_people(record)


def _count_people(record: EpisodeRecord) -> EpisodeRecord:
    """Return a record whose columns say how many people there were: the pedestrian model decides who is."""
    there = np.isfinite(record["pedestrian_positions"]).all(axis=2).any(axis=0)
    columns = {**record.meta["columns"], "n_pedestrians": int(there.sum())}
    return replace(record, meta={**record.meta, "columns": columns})


def build_benchmark(config: Mapping[str, Any], registry: Registry) -> Benchmark:
    """Build every component of a configuration, as ``compose`` returns it or in plain containers.

    Raises ConfigurationError for the first thing that is wrong, before anything runs.
    """
    config = to_plain(config)
    check_complete(config)
    settings = read_settings({k: config[k] for k in RunSettings.__slots__}, RunSettings, "")
    robot = registry.build("robot", config["robot"])
    task = registry.build("task", config["task"], robot=robot, world=registry.build("world", config["world"]))
    pedestrians = registry.build("pedestrians", config["pedestrians"])
    simulator = registry.build("simulator", config["simulator"], robot=robot, pedestrians=pedestrians)
    navigator, seeing = build_navigator(config, registry, robot, simulator.inner_step)
    check_runs_teams(simulator, config, task.robots())
    communication = _build_communication(config, registry, task.robots())
    mates = None
    if task.robots() > 1:
        mates = build_teammates(config, registry, navigator, simulator.inner_step)
        mates.look_up(task, settings.seed, simulator)
    timing = read_settings(config["timing"], Timing, "timing")
    recording = read_settings(config["recording"], RecordingSettings, "recording")
    metrics = build_metrics(config, registry)
    return Benchmark(
        config,
        settings,
        robot,
        task,
        simulator,
        navigator,
        timing,
        metrics,
        recording,
        digest_code(config, registry),
        tuple(sorted({*privileged_names(seeing), *(mates.privileged if mates else ())})),
        mates,
        communication,
    )


def _build_communication(config: Mapping[str, Any], registry: Registry, robots: int) -> Communication | None:
    """Return what carries messages between ``robots``, None where nothing does; raise ConfigurationError for one."""
    node = config.get("communication")
    if node is None:
        return None
    built: Communication = registry.build("communication", node)
    if robots == 1:
        raise ConfigurationError(
            f"communication is {node['name']}, and task {config['task']['name']} has one robot; allowed: "
            "communication=none, or a task with a team"
        )
    return built


def build_navigator(
    config: Mapping[str, Any], registry: Registry, robot: Robot, inner_step: float
) -> tuple[Navigator, Sequence[PrivilegedPart]]:
    """Build the brain of a robot, and say which of its parts see the truth; ``inner_step`` s is the simulator's."""
    control_period = _control_period(config, robot, inner_step)
    with watch_privileged() as seeing:
        parts = _build_navigation(config, registry, robot, passage_padding(config["planner"], robot))
        _check_map(config, parts.localizer)
        # its own: the others' is not its to change
        planner = registry.build("planner", config["planner"], robot=deepcopy(robot))
    parts = replace(parts, privileged=tuple(one.part for one in seeing))
    replan = read_settings(_with_planners_own(config, "replan"), ReplanRules, "replan")
    recoveries = read_settings(_with_planners_own(config, "recoveries"), RecoveryRules, "recoveries")
    return Navigator(parts, planner, replan, recoveries, control_period), seeing


def build_teammates(
    config: Mapping[str, Any], registry: Registry, navigator: Navigator, inner_step: float
) -> Teammates:
    """Return what builds the other robots of teams and their navigators, beside the ``navigator`` of the first one."""
    builders = Builders(
        lambda node: registry.build("robot", node), lambda own, body: build_navigator(own, registry, body, inner_step)
    )
    return Teammates(config, navigator, builders)


def build_guide(config: Mapping[str, Any], registry: Registry, robot: Robot) -> Guide:
    """Build what leads a robot by these parts of a configuration, ``replan`` and ``recoveries`` among them,
    for a planner in training.
    """
    check_sections(config, (*LED_BY, "replan", "recoveries"), "guide")
    replan = read_settings(config["replan"], ReplanRules, "replan")
    recoveries = read_settings(config["recoveries"], RecoveryRules, "recoveries")
    with watch_privileged() as seeing:
        parts = _build_navigation(config, registry, robot, 0.0)
    parts = replace(parts, privileged=tuple(one.part for one in seeing))
    return Guide(parts, replan, recoveries, robot.control_period)


def _build_navigation(config: Mapping[str, Any], registry: Registry, robot: Robot, margin: float) -> GuideParts:
    """Build what leads a robot; a global planner whose ``padding`` is null keeps off passages with less
    ``margin`` (m) on a side.
    """
    nodes = {"predictor": STRAIGHT, **{kind: config[kind] for kind in BRAIN if kind in config}}
    if nodes["global_planner"].get("padding", margin) is None:
        nodes["global_planner"] = {**nodes["global_planner"], "padding": margin}
    return GuideParts(robot, **{kind: registry.build(kind, node, robot=robot) for kind, node in nodes.items()})


def passage_padding(planner: Mapping[str, Any], robot: Robot) -> float:
    """Return the room beyond the robot's inscribed circle, m, that a path leaves on either side in a passage.

    The planner's ``passage_margin`` counts from the sides of the robot. Of a car they lie outside its inscribed
    circle, which is about the rear axle. Without one the planner needs room to turn: the circumscribed circle.
    With 0 a path keeps off walls by the inscribed radius alone, as that of navfn does.
    """
    body = robot.footprint
    own = planner.get("passage_margin")
    if own is None:
        return body.radius - body.inscribed_radius
    margin = read_settings(own, PassageMargin, "planner.passage_margin")
    return margin + body.half_width - body.inscribed_radius if margin > 0.0 else 0.0


def build_metrics(config: Mapping[str, Any], registry: Registry) -> dict[str, list[Metric]]:
    """Build the chosen metric packs, in the order of their names; first, under an empty name,
    the one whose columns are bare.
    """
    packs = metric_packs(config)
    built: dict[str, MetricPack] = {name: registry.build("metrics", packs[name]) for name in sorted(packs)}
    bare = [name for name, pack in built.items() if pack.bare]
    if len(bare) > 1:
        raise ConfigurationError(
            f"metrics has {' and '.join(bare)}, whose columns are bare alike; allowed: one of them"
        )
    ordered = [*bare, *(name for name in built if name not in bare)]
    return {"" if name in bare else name: list(built[name].metrics()) for name in ordered}


def metric_packs(config: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the nodes of the chosen metric packs by name; raise ConfigurationError where one is not in its place."""
    packs = config.get("metrics") or {}
    if not isinstance(packs, Mapping):
        raise ConfigurationError(f"metrics is {packs!r}; allowed: a mapping of metric packs, or null")
    if isinstance(name := packs.get("name"), str):
        raise ConfigurationError(
            f"the file of metrics={name} puts its keys where those of other packs stand; "
            f"allowed: a file that begins with # @package metrics.{name}"
        )
    return packs


def cell_config(config: Mapping[str, Any]) -> dict[str, Any]:
    """Return the part of a configuration that makes a cell: all but seed, number of episodes, executor and metrics."""
    return {key: value for key, value in config.items() if key not in NOT_PART_OF_A_CELL}


def config_hash(config: Mapping[str, Any]) -> str:
    """Return the name of a cell, eight hexadecimal digits."""
    return blake2b(json.dumps(cell_config(config), sort_keys=True).encode(), digest_size=4).hexdigest()


def identity_columns(config: Mapping[str, Any]) -> dict[str, Any]:
    """Return the columns of episodes.csv that the configuration alone decides, with
    the code that the run began with. ``privileged`` names what sees the truth and ``predictor`` who foresees
    people, where anything does, or people are not just expected to keep their velocity; ``communication`` by what a
    team tells each other.
    """
    choices = config.get("choices", {})
    seeing, predictor = config.get("privileged"), config.get("predictor", STRAIGHT)["name"]
    told = {"privileged": ", ".join(seeing)} if seeing else {}
    told |= {"predictor": choices.get("predictor", predictor)} if predictor != STRAIGHT["name"] else {}
    radio = config.get("communication")
    told |= {"communication": choices.get("communication") or radio["name"]} if radio else {}
    return told | {
        "config_hash": config_hash(config),
        "code": config.get("code", ""),
        "planner": config["planner"]["name"],
        "preset": choices.get("planner", config["planner"]["name"]),
        "robot": choices.get("robot", config["robot"]["name"]),
        "simulator": config["simulator"]["name"],
        "world": choices.get("world", config["world"]["name"]),
        "task": config["task"]["name"],
        "pedestrian_model": config["pedestrians"]["name"],
        "reaction": config["pedestrians"].get("reaction", ""),
        "localizer": config["localizer"]["name"],
        "timing": config["timing"]["mode"],
    }


def check_sections(config: Mapping[str, Any], needed: Sequence[str], place: str = "the configuration") -> None:
    """Raise ConfigurationError when ``place``, that these keys are in, lacks one that is
    ``needed``, or one is nothing with keys.
    """
    lacking = [key for key in needed if key not in config]
    if lacking:
        raise ConfigurationError(f"{place} lacks {', '.join(lacking)}; `arena list` shows what can be chosen")
    for key in needed:
        if not isinstance(config[key], Mapping):
            raise ConfigurationError(f"{key} is {config[key]!r}; allowed: a mapping, as {key}=... chooses it")


def check_complete(config: Mapping[str, Any]) -> None:
    """Raise ConfigurationError when a part of the configuration of a run is missing, or is nothing with
    keys, or nothing reads it.
    """
    check_sections(config, NEEDED)
    lacking = [key for key in RunSettings.__slots__ if key not in config]
    if lacking:
        raise ConfigurationError(
            f"the configuration lacks {', '.join(lacking)}; allowed: all of {', '.join(RunSettings.__slots__)}"
        )
    known = (*NEEDED, "predictor", "communication", "reference", *RunSettings.__slots__, "metrics", "choices")
    foreign = [str(key) for key in config if key not in known]
    if foreign:
        hint = did_you_mean(foreign[0], known)
        raise ConfigurationError(
            f"the configuration has a key {foreign[0]} that nothing reads{hint} (possible: {', '.join(known[:-1])})"
        )


def _check_map(config: Mapping[str, Any], localizer: Localizer) -> None:
    """Raise ConfigurationError when the localiser needs a map and the robot is given none."""
    if localizer.needs_map and config["world"].get("known") is False:
        name = config["localizer"]["name"]
        raise ConfigurationError(
            f"world.known is false and localizer {name} needs a map; allowed: world.known=true, or another localizer"
        )


def _with_planners_own(config: Mapping[str, Any], key: str) -> dict[str, Any]:
    """Return the run's rules with what the planner's configuration says otherwise in their place."""
    own = config["planner"].get(key) or {}
    if not isinstance(own, Mapping):
        raise ConfigurationError(f"planner.{key} is {own!r}; allowed: a mapping with keys of {key}, or null")
    for name in own:
        if name not in config[key]:
            raise ConfigurationError(f"planner.{key} has no parameter {name} (allowed: {', '.join(config[key])})")
    return {**config[key], **own}


def _control_period(config: Mapping[str, Any], robot: Robot, inner_step: float) -> float:
    """Return the planner's control period, the robot's unless the planner's YAML has
    one; it must fit the inner step.
    """
    period = config["planner"].get("control_period") or robot.control_period
    period = read_settings(period, Period, "planner.control_period")
    steps = period / inner_step
    if abs(steps - round(steps)) > 1e-6 or round(steps) < 1:
        raise ConfigurationError(
            f"planner.control_period is {period}; allowed: multiples of the inner step {inner_step} s"
        )
    return period
