"""A scene simulated for a few seconds: people as their model moves them, the robot as a planner drives it."""

from __future__ import annotations

import base64
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from arena_core.files import reading_within
from arena_core.hosting import build_benchmark, compose, load_registry, to_plain
from arena_core.records import read_grid
from arena_studio.allowed_overrides import check_overrides
from arena_studio.background.requests import PreviewScene
from arena_studio.background.scenes import content_text, quote_text, single_scene, world_of
from arena_viewer.document import RecordedEpisode, replay_document


def preview_scene(request: PreviewScene) -> dict[str, Any]:
    """Return the first seconds of a scene as a replay document in base64, and how it ended; raise ArenaError where
    it cannot run.

    With ``legs`` people walk on two of them, which lidars see, as far as the chosen ``pedestrians`` can.
    """
    words = _choose_overrides(request)
    alone = single_scene(request.content, request.scene)
    alone["scenarios"] = [{**alone["scenarios"][0], "time_limit": request.seconds, "repeats": 1}]
    with TemporaryDirectory() as folder, reading_within(Path.cwd(), Path(folder)):
        path = Path(folder) / "scene.json"
        path.write_text(content_text(request.path, alone), encoding="utf-8")
        config = compose([*words, "task=scenario", f"task.path={quote_text(str(path))}"])
        benchmark = build_benchmark(config, load_registry())
        record = benchmark.run(0, Path(folder))
        grid = read_grid(Path(folder) / record.meta["world"]["grid"])
    shown = replay_document([RecordedEpisode(record, grid, {}, str(record.meta["columns"]["preset"]))])
    return {
        "document": base64.b64encode(shown).decode(),
        "outcome": record.meta["outcome"],
        "error": record.meta["error"] or "",
    }


def _choose_overrides(request: PreviewScene) -> list[str]:
    """Return the overrides that choose what drives where among whom; raise ConfigurationError
    for what a browser may not send.
    """
    components = [f"{kind}={getattr(request, kind)}" for kind in ("robot", "planner", "pedestrians", "seed")]
    words = check_overrides([*world_of(request.map), *components, "episodes=1"], Path.cwd())
    return [*words, *(["pedestrians.body=legs"] if request.legs and _have_bodies(request.pedestrians) else [])]


def _have_bodies(pedestrians: str) -> bool:
    """Return whether a model of people says what lidars see of them."""
    return "body" in to_plain(compose([f"pedestrians={pedestrians}"], "component"))["pedestrians"]
