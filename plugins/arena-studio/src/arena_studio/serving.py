"""The server: a socket of this machine, and uvicorn on it until it is interrupted."""

from __future__ import annotations

import asyncio
import logging
import socket
from typing import Any

from arena_core import ArenaError

PATIENCE = 2  # s that open answers have at the end
LONGEST_MESSAGE = 100_000  # bytes of a websocket


def bind_socket(host: str, port: int) -> socket.socket:
    """Return a listening socket; raise ArenaError (one line) where the port is taken or the
    address is not this machine's.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    server = socket.socket(family, socket.SOCK_STREAM)
    server.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        server.bind((host, port))
        server.listen(128)
    except (OSError, OverflowError) as error:
        server.close()
        reason = getattr(error, "strerror", None) or error
        raise ArenaError(f"{host}:{port}: {reason}; allowed: a free port of this machine, or port=0 for any") from None
    return server


def make_server(app: Any) -> Any:
    """Return uvicorn for an application, all of it loaded, so that who knows the address is answered at once."""
    import uvicorn

    settings = uvicorn.Config(
        app,
        log_level="warning",
        server_header=False,
        http="h11",
        ws="websockets-sansio",
        ws_max_size=LONGEST_MESSAGE,
        timeout_graceful_shutdown=PATIENCE,
        access_log=False,
    )
    settings.load()
    return uvicorn.Server(settings)


def run_server(server: Any, listening: socket.socket) -> None:
    """Serve until Ctrl-C; ``server`` is uvicorn."""
    logging.getLogger("uvicorn.error").addFilter(_is_fault)
    try:
        server.run(sockets=[listening])
    except KeyboardInterrupt:
        pass  # uvicorn has ended in order, and raises it again
    finally:
        listening.close()


def _is_fault(record: logging.LogRecord) -> bool:
    """Return whether a line is worth saying: that open answers were cut off at the end is not."""
    error = record.exc_info[1] if record.exc_info else None
    return not isinstance(error, asyncio.CancelledError) and not record.getMessage().startswith("Cancel ")
