"""What a reader needs to repeat a run: ``provenance.json``."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import lru_cache
from hashlib import blake2b
from importlib.metadata import distributions
from pathlib import Path
from typing import Any

from pluggy import PluginManager

from arena_core.base.errors import RunFolderError, one_line
from arena_core.base.files import AnyPath, read_json
from arena_core.config.option_folders import option_files
from arena_core.runs.jobs.benchmark import config_hash
from arena_core.runs.jobs.code_digest import Code

NAME = "provenance.json"
_CPU = Path("/proc/cpuinfo")  # of Linux


def make_provenance(config: Mapping[str, Any], code: Code, notes: Sequence[str]) -> dict[str, Any]:
    """Return what a reader needs to repeat a run: versions, code, seed, commit, machine, and
    ``notes`` of what is untuned.
    """
    return {
        "config_hash": config_hash(config),
        "seed": config["seed"],
        "episodes": config["episodes"],
        "config": {key: value for key, value in config.items() if key not in ("code", "privileged")},
        "code": {"digest": code.digest, "parts": dict(code.parts)},
        "versions": dict(installed_versions()),
        "python": platform.python_version(),
        "commit": _git_commit(),
        "machine": {
            "system": platform.platform(),
            "processor": platform.machine(),
            "cpu": cpu_kind(),
            "kernels": kernels_kind(),
        },
        "untuned": list(notes),
        "privileged": list(config.get("privileged", ())),
    }


def missing_tunings(choices: Mapping[str, str], manager: PluginManager) -> list[str]:
    """Return a note for every optional tuning that a chosen component asks for and no file holds."""
    tunings = [(group.partition("@")[0], option) for group, option in choices.items() if "_tuning" in group]
    lacking = [(group, option) for group, option in tunings if option not in option_files(group, manager)]
    return [f"{group.rpartition('/')[2].removesuffix('_tuning')}: untuned for {option}" for group, option in lacking]


def installed_versions() -> Mapping[str, str]:
    """Return the version of every installed distribution, sorted by name."""
    return _read_versions(tuple(sys.path))


@lru_cache(maxsize=1)
def _read_versions(path: tuple[str, ...]) -> Mapping[str, str]:
    """Return the version of every installed distribution, sorted by name; looked up
    once in a process, as plugins are.
    """
    facts = [distribution.metadata for distribution in distributions(path=list(path))]
    # of two of a name the first is imported
    found = {fact["Name"]: fact["Version"] for fact in reversed(facts) if fact["Name"]}
    return dict(sorted(found.items()))


@lru_cache(maxsize=1)
def _git_commit() -> str:
    """Return the commit of the checkout that the core runs from, with + when it has changes;
    empty outside a checkout.
    """
    here = Path(__file__).resolve().parents[3]
    if not (here / ".git").exists():
        return ""
    try:
        command = ["git", "describe", "--always", "--dirty=+", "--abbrev=12", "--exclude=*"]
        # the words are fixed
        answer = subprocess.run(command, cwd=here, capture_output=True, text=True, check=True)  # noqa: S603
    except (OSError, subprocess.CalledProcessError):
        return ""
    return answer.stdout.strip()


@lru_cache(maxsize=1)
def cpu_kind() -> str:
    """Return what compiled code depends on: the processor's name, and a digest of what it can do
    where the kernel tells that.
    """
    with suppress(OSError):
        facts = dict(
            line.split(":", 1)
            for line in _CPU.read_text(errors="replace").partition("\n\n")[0].splitlines()
            if ":" in line
        )
        told = {key.strip(): value.strip() for key, value in facts.items()}
        able = " ".join(sorted(told.get("flags", told.get("Features", "")).split()))
        name = one_line(told.get("model name", platform.machine()), 100)
        return f"{name} {blake2b(able.encode(), digest_size=4).hexdigest()}"
    return platform.processor() or platform.machine()


def kernels_kind() -> str:
    """Return for which processor this process and its children compile, and whether kernels came ready-made for it."""
    target = os.environ.get("NUMBA_CPU_NAME", "this processor")
    ready = os.environ.get("ARENA_READY_KERNELS", "none")
    return target if ready == "none" else f"{target}, ready-made {ready}"


def read_provenance(folder: AnyPath) -> dict[str, Any]:
    """Return what a run's folder says of its run; raise RunFolderError where it is damaged."""
    path = Path(folder) / NAME
    try:
        facts: dict[str, Any] = read_json(path, "what `arena run` wrote")
        facts["config"]["seed"]
    except (KeyError, TypeError) as error:
        raise RunFolderError(f"cannot read {path}: {one_line(repr(error))}") from error
    return facts
