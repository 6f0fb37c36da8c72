"""Furniture of a map: its kinds, and the scenario files whose problems have pieces of it, for no map holds any."""

from __future__ import annotations

import json
import posixpath
from collections.abc import Mapping
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
from scipy import ndimage

from arena_core import LIMITS, InputFileError, Pose, furniture_kind, furniture_shapes, load_registry, option_files, write_text_whole
from arena_studio.errors import Missing
from arena_studio.project import Project
from arena_tasks.scenario_files.problem import PersonDefaults
from arena_tasks.scenario_files.scenario_file import FORMAT, VERSION, read_scenario_file, with_short_lists
from arena_worlds.commands.convert import DEFAULTS
from arena_worlds.commands.measure import ROBOT_RADIUS
from arena_worlds.formats.site_file import site_grid
from arena_worlds.reachable import places
