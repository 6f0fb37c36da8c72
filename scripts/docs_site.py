"""Hooks of mkdocs: pages made of files outside docs/, one for each package and each group of options, the
notebook, and the reference of all public names.
"""

from __future__ import annotations

import ast
import json
import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.files import Files
    from mkdocs.structure.pages import Page

TOP = Path(__file__).resolve().parents[1]
READMES = {path.parent.name: path for path in sorted(TOP.glob("plugins/*/README.md"))}
FROM_ELSEWHERE = {  # place in the site: file of the repository
    "readme.md": "README.md",
    "changelog.md": "CHANGELOG.md",
    "contributing.md": "CONTRIBUTING.md",
    "notebook.md": "docs/notebook.ipynb",
    **{f"packages/{name}.md": f"plugins/{name}/README.md" for name in READMES},
}
PLACES = {file: place for place, file in FROM_ELSEWHERE.items()}
SIDE_DOORS = ("parameters", "records", "commands", "files", "scenes", "hosting")  # the core's other public modules
BESIDE = {  # public names that are not arena_core's own: page, the file that says what it is, and its names
    **{f"arena_core.{name}": (f"arena_core/{name}.py", None) for name in SIDE_DOORS},
    "arena_core.testing": ("arena_core/testing/__init__.py", None),
    "arena_gym": (
        "plugins/arena-gym/src/arena_gym/envs.py",
        ["arena_gym.environment.NavigationEnv", "arena_gym.vector_environment.NavigationVectorEnv"],
    ),
}
LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(([^)\s]+)\)")
PICTURE = re.compile(r"(!\[[^\]]*\])\(([^)\s]+)\)")


def on_config(config: MkDocsConfig) -> None:
    """Put options, packages and public names behind the door "Reference"."""
    assert config.nav is not None
    (reference,) = [entry["Reference"] for entry in config.nav if "Reference" in entry]
    reference.append({"Options": [{group: place} for place, (group, _) in option_pages().items()]})
    reference.append({"Packages": [{name: f"packages/{name}.md"} for name in READMES]})
    reference.append({"Public names": [{title: place} for place, (title, _) in reference_pages().items()]})


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that are no files of docs/."""
    from mkdocs.structure.files import File

    pages = {place: (TOP / file).read_text() for place, file in FROM_ELSEWHERE.items()}
    pages |= {place: text for place, (_, text) in [*reference_pages().items(), *option_pages().items()]}
    pages["notebook.md"] = notebook_page(pages["notebook.md"])
    for place, text in pages.items():
        files.append(File.generated(config, place, content=text))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Lead links between files of the repository to pages of the site."""
    place = page.file.src_uri
    file = FROM_ELSEWHERE.get(place, f"docs/{place}")
    parts = re.split(r"(^```.*?^```$)", markdown, flags=re.M | re.S)
    return "".join(part if part.startswith("```") else convert_links(part, file, place) for part in parts)


def convert_links(text: str, file: str, place: str) -> str:
    """Return a text of the repository's ``file`` with links as they are in the site at ``place``."""

    def link(match: re.Match[str]) -> str:
        title, target = match.groups()
        if target.startswith(("http:", "https:", "mailto:", "#")):
            return match[0]
        aim, mark, anchor = target.partition("#")
        there = os.path.normpath(f"{os.path.dirname(file)}/{aim}") if os.path.dirname(file) else os.path.normpath(aim)
        led_to = PLACES.get(there) or (there.removeprefix("docs/") if there.startswith("docs/") else None)
        if led_to is None:
            return f"{title} (`{there}` in the repository)" if there not in title else title
        return f"[{title}]({os.path.relpath(led_to, os.path.dirname(place) or '.')}{mark}{anchor})"

    def picture(match: re.Match[str]) -> str:
        return match[1] + link(re.match(LINK, f"[]({match[2]})") or match)[2:]

    return PICTURE.sub(picture, LINK.sub(link, text))


def notebook_page(text: str) -> str:
    """Return a notebook as Markdown: its texts, and its code in blocks."""
    cells = [(cell["cell_type"], "".join(cell["source"])) for cell in json.loads(text)["cells"]]
    return "\n\n".join(source if kind == "markdown" else f"```python\n{source}\n```" for kind, source in cells) + "\n"


def option_pages() -> dict[str, tuple[str, str]]:
    """Return title and text of a page for each group of options, by its place: every preset's file as it is."""
    groups: dict[str, list[str]] = {}
    for path, name in sorted(option_files(), key=lambda found: found[1]):
        group = name.split("/")[0] if "/" in name else "top"
        shown = f"## {name}\n\n`{path.relative_to(TOP)}`\n\n```yaml\n{path.read_text().strip()}\n```"
        groups.setdefault(group, [f"# Options: {group}"]).append(shown)
    return {f"options/{group}.md": (group, "\n\n".join(parts) + "\n") for group, parts in groups.items()}


def option_files() -> list[tuple[Path, str]]:
    """Return the files of options of the core and of all plugins, with their names as groups have them."""
    folders = [TOP / "conf", *sorted(TOP.glob("plugins/*/src/*/conf"))]
    apart = {"arena", "_renamed"}  # the pack's scenarios, and former names
    files = [(path, path.relative_to(folder)) for folder in folders for path in folder.rglob("*.yaml")]
    return [(path, str(place.with_suffix(""))) for path, place in files if apart.isdisjoint(place.parts)]


def reference_pages() -> dict[str, tuple[str, str]]:
    """Return title and text of each page of the reference, by its place: one for each module
    that public names come from.
    """
    pages = {"reference/index.md": ("All names", name_index())}
    for module, names in public_names("arena_core/__init__.py").items():
        pages[place_of(module)] = (
            module_heading(module),
            page_of(module_heading(module), source_of(module), [f"arena_core.{name}" for name in names]),
        )
    for module, (file, names) in BESIDE.items():
        offered = names or [f"{module}.{name}" for found in public_names(file).values() for name in found]
        pages[place_of(module)] = (module, page_of(module, TOP / file, offered))
    return pages


def page_of(title: str, file: Path, names: list[str]) -> str:
    """Return a page: what a module says of itself, and names."""
    said = ast.get_docstring(ast.parse(file.read_text())) or ""
    return "\n\n".join([f"# {title}", said, *(f"::: {name}" for name in names)]) + "\n"


def name_index() -> str:
    """Return a page that lists all public names."""
    rows = ["# All public names", "", "`from arena_core import ...`", ""]
    for module, names in public_names("arena_core/__init__.py").items():
        listed = ", ".join(f"[`{name}`][arena_core.{name}]" for name in sorted(names))
        rows.append(f"- [{module_heading(module)}]({module}.md): {listed}")
    rows += ["", "Beside it:", "", *(f"- [`{module}`]({module}.md)" for module in BESIDE)]
    return "\n".join(rows) + "\n"


def public_names(file: str) -> dict[str, list[str]]:
    """Return the names that a package's ``__init__.py`` offers, by the module that each comes from."""
    tree = ast.parse((TOP / file).read_text())
    found: dict[str, list[str]] = {}
    for node in tree.body:
        if isinstance(node, ast.ImportFrom):
            found.setdefault(node.module or "", []).extend(alias.asname or alias.name for alias in node.names)
    return found


def source_of(module: str) -> Path:
    """Return the file of a module or a package of the core."""
    there = TOP / module.replace(".", "/")
    return there / "__init__.py" if there.is_dir() else there.with_suffix(".py")


def module_heading(module: str) -> str:
    """Return a module's name as a title: ``arena_core.contracts.hookspecs`` is Hookspecs."""
    return module.rpartition(".")[2].replace("_", " ").capitalize()


def place_of(module: str) -> str:
    """Return the place of a module's page."""
    return f"reference/{module}.md"
