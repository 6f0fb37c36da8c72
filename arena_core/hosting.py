"""What applications that run components need (a ROS node, a trainer, a studio): registry, composition,
episode loop, executors, forms, the truth for privileged parts.
"""

from arena_core.base.errors import (
    BrokenPlugin,
    ContractViolation,
    DuplicateComponent,
    InvalidCandidates,
    RunFolderError,
    RunStopped,
    UnknownComponent,
)
from arena_core.base.folders import lock_folder
from arena_core.base.optional import require_extra
from arena_core.config.configuration import compose, to_plain
from arena_core.config.privileged import PrivilegedPart, privileged_names, watch_privileged
from arena_core.config.registry import Registry, load_registry
from arena_core.config.search_spaces import (
    SearchRange,
    SearchSpace,
    check_ranges,
    check_search_space,
    search_space_of,
    value_at,
    values_of,
    with_values,
)
from arena_core.contracts.learning import Situation, Trainer
from arena_core.contracts.navigation import OFF_PATH, REPLAN_REASONS, WAYPOINT_FOUND, WAYPOINT_TIMEOUT
from arena_core.contracts.running import Executor, Finished, Job, Lost
from arena_core.contracts.truth import BrainPart, PeopleAhead, TeamTruth, Truth
from arena_core.loop.driving import Ending, RobotInterface, drive_episode
from arena_core.loop.episode_loop import CommandQueue, EpisodeLoop, Verdicts
from arena_core.loop.execution import Timing, mission_of, run_episode
from arena_core.loop.foreseeing import check_predictions, foresee
from arena_core.loop.guide import Guide, Mission, ReplanRules, View, pose_at_scan
from arena_core.loop.navigator import NAVIGATOR_KEYS, Decision, Navigator
from arena_core.loop.navigator import Spent as NavigatorSpent
from arena_core.loop.world_truth import WorldTruth
from arena_core.runs.api import run_jobs
from arena_core.runs.folders.outside import OutsideRun
from arena_core.runs.jobs.benchmark import Benchmark, build_benchmark, build_guide, check_sections
from arena_core.runs.jobs.code_digest import Code, digest_code
from arena_core.runs.jobs.forms import (
    Field,
    Form,
    check_settings,
    default_options,
    form_of,
    option_names,
    settings_form,
)
from arena_core.runs.jobs.working import Checked, check_job, run_job
from arena_core.runs.workers.budgets import Budgets
from arena_core.runs.workers.executors import ProcessExecutor
from arena_core.runs.workers.nodes import Delivery, Node, OtherCode, store_delivery
from arena_core.values.sensing import straight_predictions
from arena_core.values.staging import Staging

__all__ = [
    "NAVIGATOR_KEYS",
    "OFF_PATH",
    "REPLAN_REASONS",
    "WAYPOINT_FOUND",
    "WAYPOINT_TIMEOUT",
    "Benchmark",
    "BrainPart",
    "BrokenPlugin",
    "Budgets",
    "Checked",
    "Code",
    "CommandQueue",
    "ContractViolation",
    "Decision",
    "Delivery",
    "DuplicateComponent",
    "Ending",
    "EpisodeLoop",
    "Executor",
    "Field",
    "Finished",
    "Form",
    "Guide",
    "InvalidCandidates",
    "Job",
    "Lost",
    "Mission",
    "Navigator",
    "NavigatorSpent",
    "Node",
    "OtherCode",
    "OutsideRun",
    "PeopleAhead",
    "PrivilegedPart",
    "ProcessExecutor",
    "Registry",
    "ReplanRules",
    "RobotInterface",
    "RunFolderError",
    "RunStopped",
    "SearchRange",
    "SearchSpace",
    "Situation",
    "Staging",
    "TeamTruth",
    "Timing",
    "Trainer",
    "Truth",
    "UnknownComponent",
    "Verdicts",
    "View",
    "WorldTruth",
    "build_benchmark",
    "build_guide",
    "check_job",
    "check_predictions",
    "check_ranges",
    "check_search_space",
    "check_sections",
    "check_settings",
    "compose",
    "default_options",
    "digest_code",
    "drive_episode",
    "foresee",
    "form_of",
    "load_registry",
    "lock_folder",
    "mission_of",
    "option_names",
    "pose_at_scan",
    "privileged_names",
    "require_extra",
    "run_episode",
    "run_job",
    "run_jobs",
    "search_space_of",
    "settings_form",
    "store_delivery",
    "straight_predictions",
    "to_plain",
    "value_at",
    "values_of",
    "watch_privileged",
    "with_values",
]
