#!/usr/bin/env python3
"""Run import-linter with the contracts of pyproject.toml, in which ``plugins/*`` stands for the package of every folder
of plugins/.

usage: .venv/bin/python scripts/contracts.py

``"plugins/* but arena_kernels, arena_gym"`` leaves packages out; one that is no plugin's is refused.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

TOP = Path(__file__).resolve().parents[1]
PLUGINS = re.compile(r'"plugins/\*(?: but ([\w, ]+))?"')


def main() -> int:
    """Write the contracts beside import-linter's cache and check them; return the exit status."""
    from importlinter.cli import lint_imports

    written = TOP / ".import_linter_cache" / "contracts.toml"
    written.parent.mkdir(exist_ok=True)
    written.write_text(expand_plugins((TOP / "pyproject.toml").read_text(), plugin_packages()))
    return lint_imports(config_filename=str(written))


def plugin_packages() -> list[str]:
    """Return the import names of all plugins, in order."""
    return sorted(path.name for path in TOP.glob("plugins/*/src/*") if (path / "__init__.py").is_file())


def expand_plugins(text: str, names: list[str]) -> str:
    """Put the names of plugins wherever a text of TOML says ``"plugins/*"``."""

    def listed(match: re.Match[str]) -> str:
        without = set(re.findall(r"\w+", match[1] or ""))
        if unknown := without - set(names):
            sys.exit(f"pyproject.toml: no plugin: {', '.join(sorted(unknown))}; there are: {', '.join(names)}")
        return ", ".join(f'"{name}"' for name in names if name not in without)

    return PLUGINS.sub(listed, text)


if __name__ == "__main__":
    sys.exit(main())
