"""``arena replay``: recorded episodes as they moved, in a browser, as one page, as a film or a strip of pictures."""

from __future__ import annotations

import webbrowser
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from arena_core import ConfigurationError
from arena_core.commands import Command, print_notice, read_words
from arena_core.files import write_bytes_whole, write_text_whole
from arena_core.parameters import NonNegative, NonNegativeInt, Positive, PositiveInt, read_settings
from arena_core.records import find_runs
from arena_viewer.document import RecordedEpisode, read_recorded, replay_document
from arena_viewer.live import LiveRuns
from arena_viewer.page import live_page, replay_page
from arena_viewer.serving import PageServer, page_answer

USAGE = (
    "arena replay RUN [RUN...] [EPISODE...] [out=FILE.html|.mp4|.gif|.png|.replay] "
    "[with=RUN,...] [port=0] [open=true] "
    "[live=false] [side=640] [rate=20] [speed=1] [from=0] [until=END] [moments=4]"
)
KEYS = ("out", "with", "port", "open", "live", "side", "rate", "speed", "from", "until", "moments")
ENDINGS = (".html", ".mp4", ".gif", ".png", ".replay")
MOST = 12  # episodes on one page
MOST_DRAWN = 6  # side by side in a film, or below each other in a picture
SAME = ("scenario", "scenario_hash", "seed", "world")  # columns of episodes that are drawn beside each other
MOST_GIF_FRAMES = 600  # all of a GIF's frames are held until it is written


@dataclass(frozen=True, slots=True)
class Request:
    """What is to be shown: ``episodes`` of the runs in ``folders``, where to, and how a film or a strip is made."""

    folders: Sequence[Path]
    episodes: Sequence[int]
    target: Path | None
    port: int
    opens: bool
    live: bool
    side: int
    rate: float
    speed: float
    begin: float
    until: float | None
    moments: int


def read_request(arguments: Sequence[str]) -> Request:
    """Return what the words after ``arena replay`` ask for; raise ConfigurationError where they cannot be read."""
    words = read_words(USAGE, arguments, names=None, keys=KEYS)
    if not words.names:
        raise ConfigurationError(f"arguments are none; allowed: {USAGE}")
    out = words.value("out", str | None, None)
    if out is not None and Path(out).suffix not in ENDINGS:
        raise ConfigurationError(f"out is {out}; allowed: a name that ends in {', '.join(ENDINGS)}")
    others = words.value("with", str | None, None)
    runs = [name for name in words.names[1:] if "/" in name or (not name.isdecimal() and Path(name).is_dir())]
    numbers = [int(name) if name.isdecimal() else name for name in words.names[1:] if name not in runs]
    return Request(
        [Path(words.names[0]), *map(Path, runs), *(Path(name) for name in (others or "").split(",") if name)],
        [read_settings(number, NonNegativeInt, "EPISODE") for number in numbers] or [0],
        None if out is None else Path(out),
        words.value("port", NonNegativeInt, 0),
        words.value("open", bool, True),
        words.value("live", bool, False),
        words.value("side", PositiveInt, 640),
        words.value("rate", Positive, 20.0),
        words.value("speed", Positive, 1.0),
        words.value("from", NonNegative, 0.0),
        words.value("until", Positive | None, None),
        words.value("moments", PositiveInt, 4),
    )


class ReplayCommand(Command):
    """Show recorded episodes as they moved; several planners on one scenario beside each other."""

    help: ClassVar[str] = (
        "watch recorded episodes: arena replay RUN [RUN...] [EPISODE...] [out=FILE.html|.mp4|.gif|.png]"
    )

    def run(self, arguments: Sequence[str]) -> int:
        """Open a browser on the episodes, or write a file."""
        if not arguments or any(word in ("-h", "--help") for word in arguments):
            print(f"usage: {USAGE}")
            return 0
        request = read_request(arguments)
        if request.live:
            _watch_runs(request)
            return 0
        shown = [
            read_recorded(folder, number) for folder in _run_folders(request.folders) for number in request.episodes
        ]
        if len(shown) > MOST:
            raise ConfigurationError(f"{len(shown)} episodes are asked for; allowed: {MOST} at once")
        title = " · ".join(dict.fromkeys(f"{one.name}, {one.record.meta['columns']['robot']}" for one in shown))
        if request.target is None:
            _serve_page(replay_page(f"{title} - arena replay", None), replay_document(shown), request)
        else:
            _write_file(request.target, shown, f"{title} - arena replay", request)
            print_notice(f"{request.target}")
        return 0


def _run_folders(folders: Sequence[Path]) -> list[Path]:
    """Return the runs at or below the folders; a sweep's are all of its jobs."""
    found = [run for folder in folders for run in sorted(find_runs(folder), key=lambda run: (len(run.name), run.name))]
    return list(dict.fromkeys(found))


def _watch_runs(request: Request) -> None:
    """Serve the page of runs under way, until interrupted."""
    if len(request.folders) > 1 or request.target is not None:
        raise ConfigurationError(
            "live shows one folder in a browser; allowed: arena replay DIR live=true, without with and out"
        )
    watched = LiveRuns(request.folders[0].absolute())
    replay = page_answer(replay_page("arena replay", None))
    more = {"/replay": replay, "/document": watched.document, "/state": watched.state, "/map": watched.map}
    _open_server(PageServer(live_page(f"{request.folders[0].name} - arena, live"), b"", request.port, more), request)


def _serve_page(text: str, content: bytes, request: Request) -> None:
    _open_server(PageServer(text, content, request.port), request)


def _open_server(server: PageServer, request: Request) -> None:
    print_notice(f"{server.address} (Ctrl-C ends it)")
    if request.opens:
        webbrowser.open(server.address)
    server.serve()


def _write_file(target: Path, shown: Sequence[RecordedEpisode], title: str, request: Request) -> None:
    if target.suffix == ".html":
        write_text_whole(target, replay_page(title, replay_document(shown)))
    elif target.suffix == ".replay":
        write_bytes_whole(target, replay_document(shown))
    else:
        _check_comparable(target, shown)
        _draw_episodes(target, shown, request)


def _check_comparable(target: Path, shown: Sequence[RecordedEpisode]) -> None:
    """Raise ConfigurationError for episodes that one picture cannot show beside each other."""
    if len(shown) > MOST_DRAWN:
        raise ConfigurationError(
            f"out is {target.name} of {len(shown)} episodes; allowed: up to {MOST_DRAWN}, or .html"
        )
    first, *others = (one.record.meta["columns"] for one in shown)
    for other in others:
        differing = [name for name in SAME if first.get(name) != other.get(name)]
        if differing:
            said = " and ".join(str(columns.get(differing[0])) for columns in (first, other))
            raise ConfigurationError(
                f"out is {target.name} of {differing[0]} {said}; allowed: runs of the same scenario, or .html"
            )


def _draw_episodes(target: Path, shown: Sequence[RecordedEpisode], request: Request) -> None:
    from arena_drawing.film import check_encoder, write_film, write_picture
    from arena_viewer.stills import film_frames, strip_picture

    if target.suffix == ".png":
        write_picture(target, strip_picture(shown, request.moments, request.side))
        return
    check_encoder(target)
    last = max(float(one.record["stamp"][-1]) for one in shown)
    end = last if request.until is None else min(request.until, last)
    if end <= request.begin:
        raise ConfigurationError(
            f"from is {request.begin:g} and until {end:g}; allowed: times before the end of the episode, {last:g} s"
        )
    stamps = np.arange(request.begin, end, request.speed / request.rate)
    most = MOST_GIF_FRAMES // len(shown)
    if target.suffix == ".gif" and len(stamps) > most:
        raise ConfigurationError(
            f"out is {target.name} of {len(stamps)} frames; allowed: {most} (a smaller rate), or .mp4"
        )
    size, pictures = film_frames(shown, stamps.tolist(), request.side)
    write_film(target, pictures, size, request.rate)
