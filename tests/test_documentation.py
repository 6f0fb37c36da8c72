"""The documentation says what the code does: every hook, interface, group, command, array and example."""

import abc
import importlib.util
import inspect
import json
import re
from dataclasses import asdict, fields
from importlib import import_module
from pathlib import Path

import pytest
import yaml

import arena_core
from arena_core import Observation, testing
from arena_core.contracts import hookspecs, learning, navigation, running, simulation
from arena_core.files import LIMITS
from arena_core.hosting import load_registry
from arena_core.loop.guide import ReplanRules
from arena_core.loop.record_layout import EXTRAS
from arena_core.runs.jobs.benchmark import RunSettings
from arena_core.testing import record

TOP = Path(__file__).resolve().parents[1]
DOCS = TOP / "docs"
PAGES = sorted([*TOP.glob("*.md"), *DOCS.rglob("*.md"), *TOP.glob("plugins/*/README.md")])
HOOKS = {name: hook for name, hook in vars(hookspecs).items() if hasattr(hook, "arena_spec")}
INTERFACES = [
    kind
    for module in (learning, navigation, running, simulation)
    for _, kind in inspect.getmembers(module, inspect.isclass)
    if issubclass(kind, abc.ABC) and kind is not abc.ABC
]

SEEN = ["Observation", "LaserScan", "Tracks", "Costmap", "Path", "OccupancyGrid", "Pose", "Twist", "EpisodeStart"]
SEEN += ["Robot", "Footprint", "VelocityLimits", "Lidar", "OdometryModel", "Sensors", "Odometry", "PoseEstimate"]


def page(name):
    return (DOCS / name).read_text()


def signature(function):
    """Return a function's name with its parameters, ``*`` before those that are given by keyword alone."""
    parameters = [one for one in inspect.signature(function).parameters.values() if one.name != "self"]
    by_name = [one.name for one in parameters if one.kind is one.KEYWORD_ONLY]
    by_place = [one.name for one in parameters if one.kind is not one.KEYWORD_ONLY]
    return f"{function.__name__}({', '.join([*by_place, *(['*'] if by_name else []), *by_name])})"


def test_every_hook_has_a_heading_with_exactly_its_arguments():
    headings = re.findall(r"^### (\w+\(.*\))$", page("plugins.md"), re.M)
    assert sorted(headings) == sorted(signature(hook) for hook in HOOKS.values())


@pytest.mark.parametrize("kind", INTERFACES, ids=lambda kind: kind.__name__)
def test_every_method_of_an_interface_is_documented_with_exactly_its_arguments(kind):
    text = page("plugins.md")
    assert f"`{kind.__name__}`" in text
    for name, method in vars(kind).items():
        if inspect.isfunction(method) and not name.startswith("_"):
            assert f"| `{signature(method)}` |" in text


def test_every_hook_begins_with_one_sentence():
    assert all((hook.__doc__ or "").splitlines()[0].endswith(".") for hook in HOOKS.values())


@pytest.mark.parametrize("kind", [getattr(arena_core, name) for name in SEEN], ids=SEEN)
def test_every_field_that_a_planner_reads_is_on_one_page(kind):
    text = page("planner_author.md")
    section = re.search(rf"^## {kind.__name__}$(.*?)(?=^## |\Z)", text, re.M | re.S)
    shown = (
        {name for name, member in vars(kind).items() if isinstance(member, property)} if kind is Observation else set()
    )
    for name in {field.name for field in fields(kind) if not field.name.startswith("_")} | shown:
        assert f"| `{kind.__name__}.{name}` |" in text or f"| `{name}` |" in (section[1] if section else "")


def test_every_group_and_setting_is_documented():
    text = page("configuration.md")
    config = yaml.safe_load((TOP / "conf" / "config.yaml").read_text())
    config["replan"] = yaml.safe_load((TOP / "conf" / "replan" / "default.yaml").read_text())
    groups = {
        k: v
        for entry in config["defaults"]
        if isinstance(entry, dict)
        for k, v in entry.items()
        if not k.startswith("override")
    }
    for group, default in groups.items():
        if group != "experiment" and not group.startswith("optional "):
            assert f"| `{group}` | {'' if default is None else f'`{default}` '}|".replace("'", "") in text
    for name in RunSettings.__slots__:
        assert f"| `{name}` | {json.dumps(config[name])} |" in text
    for name in ReplanRules.__slots__:
        assert (
            f"| `replan.{name}` | {'null' if config['replan'][name] is None else str(config['replan'][name]).lower()} |"
            in text
        )


def test_the_experiment_in_the_documentation_is_the_real_one():
    assert (TOP / "conf" / "experiment" / "smoke.yaml").read_text() in page("configuration.md")


def test_every_command_is_documented():
    text = page("command_line.md")
    for name in load_registry().names("command"):
        assert f"## arena {name}\n" in text


def test_every_limit_is_documented_with_its_value():
    said = dict(re.findall(r"^\| `(\w+)` \| ([0-9e.-]+) \|", page("limits.md"), re.M))
    assert {name: float(value) for name, value in said.items()} == {
        name: float(value) for name, value in asdict(LIMITS).items()
    }


def documented_arrays():
    """Return the type of each array that docs/records.md lists, float64 where it says none."""
    rows = re.findall(r"^\| `(\w+)` \| \([^)]*\)(?: (\w+))? \|", page("records.md"), re.M)
    return {name: kind or "float64" for name, kind in rows if name != "meta"}


def test_every_array_of_a_record_is_documented():
    assert set(documented_arrays()) == {*record().arrays, "scan_ranges", *EXTRAS}


def test_the_types_of_arrays_are_as_documented():
    types = documented_arrays()
    assert all(types[name] == str(array.dtype) for name, array in record(contact=True).arrays.items())


def test_the_tutorial_is_the_code_of_the_specimen():
    folder = TOP / "plugins" / "arena-pure-pursuit"
    sources = [path.read_text() for path in folder.rglob("*") if path.suffix in (".py", ".toml", ".yaml")]
    blocks = re.findall(r"^```(?:python|toml|yaml)\n(.*?)^```$", page("tutorial.md"), re.M | re.S)
    assert len(blocks) == 5
    for block in blocks:
        assert any(block.strip() in source for source in sources), block


def test_the_specimen_is_40_lines():
    lines = (TOP / "plugins/arena-pure-pursuit/src/arena_pure_pursuit/__init__.py").read_text().splitlines()
    assert len([line for line in lines if line.strip()]) <= 40


WIDE = DOCS / "results" / "paper.md"  # its tables of verdicts


@pytest.mark.parametrize("path", [page for page in PAGES if page != WIDE], ids=lambda path: str(path.relative_to(TOP)))
def test_no_line_is_above_160_characters(path):
    assert [line[:60] for line in path.read_text().splitlines() if len(line) > 160] == []


@pytest.mark.parametrize("path", PAGES, ids=lambda path: str(path.relative_to(TOP)))
def test_inner_lists_are_indented_by_four(path):
    """With fewer blanks the site takes their items for those of the outer list."""
    text = re.sub(r"^```.*?^```", "", path.read_text(), flags=re.M | re.S)
    assert re.findall(r"^ {1,3}(?:[-*]|\d+\.) .{,40}", text, re.M) == []


def test_reference_has_all_public_names():
    site = docs_site()
    listed = re.findall(r"^::: (\S+)$", "\n".join(text for _, text in site.reference_pages().values()), re.M)
    assert {f"arena_core.{name}" for name in arena_core.__all__} <= set(listed)
    for door in map(import_module, (f"arena_core.{name}" for name in site.SIDE_DOORS)):
        assert {f"{door.__name__}.{name}" for name in door.__all__} <= set(listed)
    assert {f"arena_core.testing.{name}" for name in testing.__all__} <= set(listed)


def test_every_page_is_behind_a_door():
    nav = yaml.safe_load((TOP / "mkdocs.yml").read_text())["nav"]
    assert [*map(next, map(iter, nav))][1:] == ["Tutorials", "How-to", "Reference", "Explanation", "Results"]
    named = re.findall(r": ([\w/]+\.md)$", (TOP / "mkdocs.yml").read_text(), re.M)
    there = [str(path.relative_to(DOCS)) for path in DOCS.rglob("*.md")]
    assert sorted(named) == sorted([*there, "changelog.md", "contributing.md", "readme.md", "notebook.md"])


def test_search_splits_words_where_keys_and_options_do():
    """What the site's search looks for: words of `hydra/launcher=joblib`, and every key of every file of options."""
    separator = re.search(r"separator: '(.*?)'", (TOP / "mkdocs.yml").read_text())[1]
    site = docs_site()
    pages = [*(path.read_text() for path in PAGES), *(text for _, text in site.option_pages().values())]
    words = {word for text in pages for word in re.split(separator, text)}
    files = [path.read_text() for path, _ in site.option_files()]
    keys = {key for text in files for key in re.findall(r"^ *(\w+):", text, re.M)}
    assert {"optuna", "joblib", "circle_radius", "recoveries", "results", "LaserScan"} | keys <= words


def docs_site():
    """Return the module of hooks with which the site is built."""
    spec = importlib.util.spec_from_file_location("docs_site", TOP / "scripts" / "docs_site.py")
    site = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(site)
    return site


def test_the_notebook_becomes_a_page():
    text = docs_site().notebook_page((DOCS / "notebook.ipynb").read_text())
    assert text.startswith("# From Python")
    assert "```python\nimport arena_core as arena\n" in text


@pytest.mark.parametrize("path", PAGES, ids=lambda path: str(path.relative_to(TOP)))
def test_every_link_leads_somewhere(path):
    links = re.findall(r"\]\(([^)\s]+)\)", path.read_text())
    for link in links:
        if link.startswith("http"):
            continue
        file, _, anchor = link.partition("#")
        target = path.parent / file if file else path
        assert target.exists(), link
        if anchor:
            titles = re.findall(r"^#+ (.*)$", target.read_text(), re.M)
            assert anchor in [re.sub(r"[^\w -]", "", title).lower().replace(" ", "-") for title in titles]


@pytest.mark.parametrize("package", sorted(path.name for path in (TOP / "plugins").iterdir() if path.is_dir()))
def test_every_plugin_is_named_in_the_architecture(package):
    assert f"| {package} |" in page("architecture.md")


def test_the_layers_in_the_documentation_are_those_that_are_held():
    import tomllib

    contracts = tomllib.loads((TOP / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    (layers,) = [contract["layers"] for contract in contracts if contract.get("containers") == ["arena_core"]]
    assert "\n".join(layer.replace(" | ", "   ") for layer in layers) in page("architecture.md")
