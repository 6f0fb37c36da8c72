"""Put ready-made kernels into the wheel where a folder of them is given: it is one for a platform and a Python then."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

GIVEN = "ARENA_READY_FOLDER"  # what `arena compile out=DIR` has filled
PLATFORMS = {"linux-x86_64": "manylinux_2_27_x86_64"}  # as numba's own wheels


class ReadyKernels(BuildHookInterface):  # type: ignore[type-arg]
    """Adds a folder, and says for what its kernels are."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Take the folder that the environment names."""
        if not (given := os.environ.get(GIVEN)):
            return
        manifest = json.loads(Path(given, "ready.json").read_text())
        python = manifest["python"].replace("cpython-", "cp")
        build_data["tag"] = f"{python}-{python}-{PLATFORMS[manifest['platform']]}"
        build_data["pure_python"] = False
        build_data["force_include"][given] = "arena_kernels/ready"
