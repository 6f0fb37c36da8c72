"""The documentation says what the code does: every hook, interface, group, command, array and example."""

import abc
import inspect
import re
from pathlib import Path

import pytest
import yaml

from arena_core import hookspecs, interfaces, learning, load_registry
from arena_core.benchmark import RunSettings
from arena_core.configuration import compose
from arena_core.navigator import ReplanRules
from arena_core.testing import record

TOP = Path(__file__).resolve().parents[1]
DOCS = TOP / "docs"
PAGES = sorted([TOP / "README.md", TOP / "CHANGELOG.md", *DOCS.glob("*.md"), *TOP.glob("plugins/*/README.md")])
HOOKS = {name: hook for name, hook in vars(hookspecs).items() if hasattr(hook, "arena_spec")}
INTERFACES = [
    kind
    for module in (interfaces, learning)
    for _, kind in inspect.getmembers(module, inspect.isclass)
    if issubclass(kind, abc.ABC) and kind is not abc.ABC
]


def page(name):
    return (DOCS / name).read_text()


def signature(function):
    return f"{function.__name__}({', '.join(name for name in inspect.signature(function).parameters if name != 'self')})"


def examples(kind):
    """Yield the ``arena KIND ...`` lines of all pages."""
    for path in PAGES:
        for line in path.read_text().splitlines():
            match = re.match(rf"^(?:\$ |\.venv/bin/)?arena {kind}\b(.*?)(?:\s{{2,}}#.*)?$", line.strip())
            if match:
                yield path.relative_to(TOP), match.group(1).split()


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


def test_every_hook_has_one_sentence():
    assert all(hook.__doc__ and hook.__doc__.endswith(".") for hook in HOOKS.values())


def test_every_group_and_setting_is_documented():
    text = page("configuration.md")
    config = yaml.safe_load((TOP / "conf" / "config.yaml").read_text())
    groups = {k: v for entry in config["defaults"] if isinstance(entry, dict) for k, v in entry.items() if not k.startswith("override")}
    for group, default in groups.items():
        if group != "experiment" and not group.startswith("optional "):
            assert f"| `{group}` | {'' if default is None else f'`{default}` '}|".replace("'", "") in text
    for name in RunSettings.__slots__:
        assert f"| `{name}` | {str(config[name]).lower()} |" in text
    for name in ReplanRules.__slots__:
        assert f"| `replan.{name}` | {'null' if config['replan'][name] is None else str(config['replan'][name]).lower()} |" in text


def test_the_experiment_in_the_documentation_is_the_real_one():
    assert (TOP / "conf" / "experiment" / "smoke.yaml").read_text() in page("configuration.md")


def test_every_command_is_documented():
    text = page("command_line.md")
    for name in load_registry().names("command"):
        assert f"## arena {name}\n" in text


def documented_arrays():
    """Return the type of each array that docs/records.md lists, float64 where it says none."""
    rows = re.findall(r"^\| `(\w+)` \| \([^)]*\)(?: (\w+))? \|", page("records.md"), re.M)
    return {name: kind or "float64" for name, kind in rows if name != "meta"}


def test_every_array_of_a_record_is_documented():
    assert set(documented_arrays()) == {*record().arrays, "scan_ranges"}


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


def is_real(words):
    return not any(word in " ".join(words) for word in ("my_", "KEY=VALUE", "DIR"))


RUNS = [(str(path), words) for path, words in examples("run") if is_real(words)]


@pytest.mark.parametrize(("path", "words"), RUNS, ids=[f"{path} {' '.join(words)}" for path, words in RUNS])
def test_every_example_of_a_run_can_be_composed(path, words):
    overrides = [re.sub(r"=([^\[,]*),.*", r"=\1", word) for word in words if "=" in word]
    shown_as_wrong = {"planner.gain=0", "planner=dwwa"} & set(words)
    if not shown_as_wrong:
        compose(overrides)


def test_there_are_examples():
    assert len(RUNS) > 10


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
    (layers,) = [contract["layers"] for contract in contracts if contract["type"] == "layers"]
    assert "\n".join(layer.replace(" | ", "   ") for layer in layers) in page("architecture.md")
