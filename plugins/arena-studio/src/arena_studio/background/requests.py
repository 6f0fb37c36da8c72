"""The requests that the server has answered in a process beside it; some are the bodies that a page sends."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import BaseModel, ConfigDict, Field, SkipValidation

LONGEST_PREVIEW = 60.0  # s of simulated time
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9_.\-/]{1,80}$")]
FilePath = Annotated[str, Field(max_length=400)]
Seed = Annotated[int, Field(ge=0, lt=2**63)]
Text = Annotated[str, Field(max_length=300)]
FileNames = Annotated[list[str], SkipValidation]  # files of the project, whatever they are called
# parameters of a task
Rules = dict[Annotated[str, Field(pattern=r"^[a-z_]+(\.[a-z_]+){0,2}$")], bool | int | float | Name]


class WorkRequest(BaseModel):
    """A request: ``what`` messages call it, ``work`` is the function of this package that takes it and answers."""

    model_config = ConfigDict(frozen=True)
    what: ClassVar[str]
    work: ClassVar[str]


class SceneKinds(WorkRequest):
    """What a scenario can be made of."""

    what, work = "kinds", "background.scenes:scene_kinds"


class ListScenarios(WorkRequest):
    """Which files are scenario files."""

    what, work = "list", "background.scenes:list_scenarios"
    names: FileNames


class OpenScenario(WorkRequest):
    """A scenario file in our format."""

    what, work = "open", "background.scenes:open_scenario"
    path: str


class ScenarioText(WorkRequest):
    """The text of a scenario file of ours."""

    what, work = "text", "background.scenes:scenario_file_text"
    path: str
    content: dict[str, Any]


class MapCells(WorkRequest):
    """A map's cells."""

    what, work = "map", "background.scenes:map_cells"
    path: str


class SceneContent(WorkRequest):
    """A scenario file as the page holds it: in our format, under the name that it has or will have; ``map``
    is relative to the project.
    """

    path: FilePath
    content: dict[str, Any]
    map: FilePath = ""


class CheckScenes(SceneContent):
    """What is to be checked, for whom."""

    what, work = "check", "background.scenes:check_scenes"
    robot: Name = "turtlebot3"
    pedestrians: Name = "social_force"


class PreviewScene(CheckScenes):
    """What is to be simulated; with ``legs`` people walk on two of them, which lidars see."""

    what, work = "preview", "background.previews:preview_scene"
    scene: Annotated[int, Field(ge=0)]
    planner: Name = "pure_pursuit"
    seconds: Annotated[float, Field(gt=0.0, le=LONGEST_PREVIEW)] = 20.0
    seed: Seed = 0
    legs: bool = False


class ExportScene(SceneContent):
    """Which scene is to be written in which format, to which file that is not there yet."""

    what, work = "export", "background.scenes:export_scene"
    scene: Annotated[int, Field(ge=0)]
    format: Name
    target: FilePath


class DrawScenes(WorkRequest):
    """Which rules draw, where: in a map of the project or in a world by its name, for which robot.

    ``rules`` are parameters of task=random by their dotted names.
    """

    what, work = "draws", "background.draws:draw_scenes"
    rules: Rules
    world: Name = "indoor"
    map: FilePath = ""
    difficulty: Annotated[float, Field(ge=0.0, le=1.0)] | None = None
    robot: Name = "turtlebot3"
    seed: Seed = 0
    count: Annotated[int, Field(ge=1, le=20)] = 10


class TaskRules(WorkRequest):
    """Under which name of task=NAME rules are kept, and of which task they are."""

    what, work = "rules", "background.draws:task_option_text"
    name: Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,60}$")]
    rules: Rules
    task: Literal["random", "staged"] = "random"


class ListCurricula(WorkRequest):
    """Which files are curricula, and those that come with the suite."""

    what, work = "curricula", "background.curricula:list_curricula"
    names: FileNames


class CurriculumLevels(WorkRequest):
    """The levels of a curriculum, by its file or its built-in name."""

    what, work = "levels", "background.curricula:curriculum_levels"
    name: str


class CheckLevels(WorkRequest):
    """Whether the levels of a curriculum hold."""

    what, work = "check levels", "background.curricula:check_levels"
    rows: list[Any]


class ListPacks(WorkRequest):
    """Which files are those of scenario packs."""

    what, work = "packs", "background.curricula:list_packs"
    names: FileNames


class MakePack(WorkRequest):
    """Which files make a pack in which folder, and how it is called."""

    what, work = "pack", "background.curricula:make_scenario_pack"
    folder: FilePath
    files: Annotated[list[FilePath], Field(max_length=1000)]
    id: Text = ""
    version: Text = ""
    title: Text = ""
    licence: Text = ""


class ComposeExperiment(WorkRequest):
    """Options by group, texts by key, and words as one types them."""

    what, work = "compose", "background.configurations:compose_configuration"
    choices: dict[str, list[str]]
    values: dict[str, str]
    more: str


class OptionForm(WorkRequest):
    """The parameters of an option."""

    what, work = "form", "background.configurations:option_form"
    group: str
    option: str


class WorldKinds(WorkRequest):
    """The kinds of worlds that can be drawn."""

    what, work = "world kinds", "background.worlds:world_kinds"


class FurnitureKinds(WorkRequest):
    """The kinds of furniture."""

    what, work = "furniture", "background.worlds:furniture_shapes_by_kind"


class DrawWorld(WorkRequest):
    """The first world of a seed; ``parameters`` as JSON."""

    what, work = "draw", "background.worlds:draw_first_world"
    kind: str
    seed: int
    parameters: str


class OpenWorld(WorkRequest):
    """A world of the project."""

    what, work = "world", "background.worlds:open_world"
    path: str


class MeasureWorld(WorkRequest):
    """How difficult a world of the project is."""

    what, work = "measures", "background.worlds:measure_world"
    path: str
    robot_radius: float | None


class RouteEnds(WorkRequest):
    """A start and a goal across a world of the project."""

    what, work = "ends", "background.worlds:route_ends"
    path: str
