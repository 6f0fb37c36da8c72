"""``arena studio``: the suite in the browser."""

from __future__ import annotations

import ipaddress
import os
import secrets
import webbrowser
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from arena_core import ConfigurationError
from arena_core.commands import Command, print_notice, read_words
from arena_core.parameters import NonNegativeInt

USAGE = "arena studio [FOLDER] [port=0] [open=true] [host=127.0.0.1] [expose=false]"
KEYS = ("port", "open", "host", "expose")
EXPOSED = (
    "host is {host}, which other machines reach; allowed: a loopback address, or expose=true: "
    "whoever knows the token can then start "
    "programs of this machine through its runs, and the token crosses the network unencrypted"
)


@dataclass(frozen=True, slots=True)
class Request:
    """What is to be served where; ``exposed``: to other machines."""

    folder: Path
    port: int
    opens: bool
    host: str
    exposed: bool


def read_request(arguments: Sequence[str]) -> Request:
    """Return what the words after ``arena studio`` ask for; raise ConfigurationError where they cannot be read."""
    words = read_words(USAGE, arguments, names=None, keys=KEYS)
    if len(words.names) > 1:
        raise ConfigurationError(f"arguments are {' '.join(words.names)}; allowed: {USAGE}")
    host = words.value("host", str, "127.0.0.1")
    exposed = not _is_loopback(host)
    if exposed and not words.value("expose", bool, False):
        raise ConfigurationError(EXPOSED.format(host=host))
    folder = Path(words.names[0]) if words.names else Path(".")
    return Request(folder, words.value("port", NonNegativeInt, 0), words.value("open", bool, True), host, exposed)


class StudioCommand(Command):
    """Open a folder in the browser: runs, results, maps, scenarios."""

    help: ClassVar[str] = "runs, results and editors in the browser: arena studio [FOLDER] [port=0] [open=true]"

    def run(self, arguments: Sequence[str]) -> int:
        """Serve the folder until Ctrl-C."""
        if any(word in ("-h", "--help") for word in arguments):
            print(f"usage: {USAGE}")
            return 0
        request = read_request(arguments)
        from arena_studio.project import Project
        from arena_studio.serving import bind_socket, make_server, run_server

        project = Project(request.folder)
        listening = bind_socket(request.host, request.port)
        from arena_studio.access import LOOPBACK
        from arena_studio.app import make_app
        from arena_studio.background.process import side_processes

        os.chdir(project.root)  # what a run reads and writes, and the user's own conf, are meant from there
        token = secrets.token_urlsafe(24)
        side_processes(project.root).runs.start()  # which the first page asks at once
        server = make_server(make_app(project, token, None if request.exposed else LOOPBACK))
        address = f"http://{_format_host(request.host)}:{listening.getsockname()[1]}/?token={token}"
        print_notice(f"{address} (Ctrl-C ends it)")
        if request.opens:
            webbrowser.open(address)
        run_server(server, listening)
        return 0


def _is_loopback(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        raise ConfigurationError(f"host is {host}; allowed: an address in digits, or localhost") from None


def _format_host(host: str) -> str:
    """Return a host as it stands in an address."""
    return f"[{host}]" if ":" in host else host
