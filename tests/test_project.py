"""The project's own settings: plugins are named once, by their folders, and state what they stand on."""

import gzip
import importlib.util
import re
import shutil
import subprocess
import tomllib
from pathlib import Path

import numpy as np
import pytest
import yaml
from PIL import Image

import arena_core

TOP = Path(__file__).resolve().parents[1]
PLUGINS = sorted(path.parent for path in TOP.glob("plugins/*/pyproject.toml"))
APART = {"arena-policies"}  # what others need and no user chooses
plugins = pytest.mark.parametrize("plugin", PLUGINS, ids=lambda path: path.name)


def settings(path):
    return tomllib.loads((path / "pyproject.toml").read_text())


def needs(project):
    """Yield name, extras included, and bounds of all that a distribution requires."""
    for line in [
        *project["dependencies"],
        *(line for extra in project.get("optional-dependencies", {}).values() for line in extra),
    ]:
        yield re.fullmatch(r"([a-z0-9_-]+)(?:\[\w+\])?(.*)", line.lower()).groups()


@plugins
def test_plugin_states_bounds_on_every_distribution_of_the_suite(plugin):
    major, minor, _ = arena_core.__version__.split(".")
    bounds = f">={major}.{minor},<{major}.{int(minor) + 1}"
    project = settings(plugin)["project"]
    assert project["version"] == arena_core.__version__
    assert {bounds} >= {said for name, said in needs(project) if name.startswith("arena-")}
    assert plugin.name == "arena-kernels" or "arena-core" in dict(needs(project))


@plugins
def test_plugin_that_uses_insides_of_numba_bounds_it_above(plugin):
    insides = [path for path in plugin.glob("src/**/*.py") if re.search(r"numba\.core|\b_nrt\b", path.read_text())]
    assert not insides or "<" in dict(needs(settings(plugin)["project"]))["numba"]


def script(name):
    """Return a script as a module."""
    spec = importlib.util.spec_from_file_location(name, TOP / "scripts" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def contracts():
    """Return the script that runs import-linter."""
    return script("contracts")


def test_contracts_take_plugins_from_their_folders(contracts):
    assert contracts.plugin_packages() == sorted(package.name for plugin in PLUGINS for package in plugin.glob("src/*"))


@plugins
def test_distribution_brings_all_its_packages(plugin):
    packages = {f"src/{package.name}" for package in plugin.glob("src/*") if package.is_dir()}
    project = settings(plugin)
    assert set(project["tool"]["hatch"]["build"]["targets"]["wheel"].get("packages", [])) == packages
    points = project["project"].get("entry-points", {}).get("arena", {})
    assert {f"src/{module}" for module in points.values()} <= packages


def test_suite_needs_or_offers_every_distribution():
    suite = settings(TOP / "plugins" / "arena-suite")["project"]
    extras = suite["optional-dependencies"]
    assert {name for name, _ in needs(suite)} == {"arena-core", *(plugin.name for plugin in PLUGINS)} - {
        "arena-suite"
    } - APART
    every = {re.match(r"[a-z0-9-]+", line)[0] for line in (*suite["dependencies"], *extras["all"])}
    assert every >= {name for name, _ in needs(suite)} - {"arena-cluster"}


def test_there_are_at_most_30_distributions():
    assert len(PLUGINS) + 1 <= 30


def test_plugin_of_a_new_folder_is_under_the_contracts(contracts):
    text = contracts.expand_plugins((TOP / "pyproject.toml").read_text(), [*contracts.plugin_packages(), "arena_new"])
    said = tomllib.loads(text)["tool"]["importlinter"]
    held = {contract["name"]: contract for contract in said["contracts"]}
    assert len(held) == 23
    assert "arena_new" in said["root_packages"]
    assert "arena_new" in held["The core knows no plugin"]["forbidden_modules"]
    (apart,) = [contract for contract in held.values() if contract["type"] == "independence"]
    assert "arena_new" in apart["modules"]
    for name in ("Plugins use the public core, never its insides", "A plugin's hook module loads nothing heavy"):
        assert "arena_new" in held[name]["source_modules"]


def test_contract_that_leaves_out_what_is_no_plugin_is_refused(contracts):
    with pytest.raises(SystemExit, match="no plugin: arena_nothing; there are: arena_dwa"):
        contracts.expand_plugins('modules = ["plugins/* but arena_nothing"]', ["arena_dwa"])


def test_settings_name_no_plugin_but_those_that_a_contract_is_about():
    said = set(re.findall(r"arena_\w+", (TOP / "pyproject.toml").read_text())) - {"arena_core"}
    about = (
        "cadrl",
        "drawing",
        "gym",
        "kernels",
        "mujoco",
        "navrep",
        "policies",
        "prediction",
        "metrics",
        "ros",
        "sim2d",
    )
    about = (*about, "break", "ladder", "reference", "submit")
    shown = ("studio", "tasks", "tuning", "viewer", "worlds")  # the studio, and what it shows and edits
    assert said <= {f"arena_{name}" for name in (*about, *shown)}


def test_markers_of_what_is_apart_have_a_target_and_a_set_up():
    (apart,) = re.findall(r"^APART := (.*)$", (TOP / "Makefile").read_text(), re.M)
    options = settings(TOP)["tool"]["pytest"]["ini_options"]
    markers = {marker.partition(":")[0] for marker in options["markers"]}
    for name in apart.split():
        assert name in markers
        assert f"not {name}" in options["addopts"]
        assert (TOP / "scripts" / f"{name}.txt").is_file()
        assert f"\n{name})\n" in (TOP / "scripts" / "setup").read_text()
        assert f"test-{name}" in (TOP / ".ci" / "run").read_text()


def copied(folder):
    """Copy what holds a version."""
    held = [
        "pyproject.toml",
        "CITATION.cff",
        "arena_core/__init__.py",
        *(str(path.relative_to(TOP)) for path in TOP.glob("plugins/*/pyproject.toml")),
    ]
    for name in held:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(TOP / name, folder / name)
    return {name: (folder / name).read_text() for name in held}


def test_release_writes_its_version_everywhere(tmp_path):
    before = copied(tmp_path)
    write = script("set_version").main
    write(arena_core.__version__, tmp_path)
    assert {name: (tmp_path / name).read_text() for name in before} == before
    write("1.7.0", tmp_path)
    after = {name: (tmp_path / name).read_text() for name in before}
    assert all("1.7.0" in text for text in after.values())
    assert '"arena-policies>=1.7,<1.8"' in after["plugins/arena-aio/pyproject.toml"]
    assert '"arena-gym[train]>=1.7,<1.8"' in after["plugins/arena-aio/pyproject.toml"]
    with pytest.raises(SystemExit, match=r"version is 1\.7; allowed: MAJOR\.MINOR\.PATCH"):
        write("1.7", tmp_path)


def test_hosted_workflow_tries_the_versions_that_are_claimed():
    workflow = yaml.safe_load((TOP / ".github" / "workflows" / "ci.yml").read_text())
    matrix = workflow["jobs"]["test"]["strategy"]["matrix"]
    assert matrix["python"] == ["3.11", "3.12", "3.13"]
    assert settings(TOP)["project"]["requires-python"] == f">={matrix['python'][0]}"
    steps = [step["run"] for job in workflow["jobs"].values() for step in job["steps"] if "run" in step]
    for target in {word for step in steps if step.startswith("make ") for word in step.split()[1:] if "=" not in word}:
        subprocess.run(["make", "--dry-run", target], cwd=TOP, check=True, capture_output=True)
    assert {f"make {target} PYTHON=python" for target in ("lint", "test", "test-slow", "test-browser")} <= set(steps)
    assert not {plugin.name for plugin in PLUGINS} & set(re.findall(r"arena-[a-z-]+", str(workflow)))


def test_citation_is_of_this_version():
    citation = yaml.safe_load((TOP / "CITATION.cff").read_text())
    assert (citation["cff-version"], citation["version"]) == ("1.2.0", arena_core.__version__)
    assert {"message", "title", "authors"} <= citation.keys()


def test_commits_are_checked_by_what_is_set_up():
    hooks = [
        hook
        for repo in yaml.safe_load((TOP / ".pre-commit-config.yaml").read_text())["repos"]
        for hook in repo["hooks"]
    ]
    assert all(hook["language"] == "system" and hook["entry"].startswith(".venv/bin/") for hook in hooks)
    assert {"pre-commit", "pre-commit-hooks", "ruff", "import-linter"} <= set(
        (TOP / "scripts" / "tools.txt").read_text().split()
    )


def content(path):
    """Return what a fixture holds: the grey values of a picture, whatever program packed it."""
    if path.suffix in (".png", ".pgm", ".bmp"):
        return np.asarray(Image.open(path)).tolist()
    return gzip.decompress(path.read_bytes()) if path.suffix == ".gz" else path.read_bytes()


def test_fixtures_are_those_that_their_script_draws(tmp_path):
    kept = TOP / "tests" / "data"
    script("draw_fixtures").main(tmp_path)
    drawn = {path.relative_to(tmp_path): content(path) for path in tmp_path.rglob("*") if path.is_file()}
    assert drawn == {path.relative_to(kept): content(path) for path in kept.rglob("*") if path.is_file()}
