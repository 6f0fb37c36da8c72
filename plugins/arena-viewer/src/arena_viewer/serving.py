"""A server of one page on this machine alone: a token in the address, no name but the
loopback's, nothing of the disk.
"""

from __future__ import annotations

import hmac
import secrets
from collections.abc import Callable, Mapping
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, ClassVar
from urllib.parse import parse_qsl, urlsplit

from arena_core import ArenaError

HOST = "127.0.0.1"
Answer = Callable[[Mapping[str, str]], tuple[str, bytes]]  # from what the address asks to a type and a content
POLICY = (
    "default-src 'none'; script-src data: 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; connect-src 'self'"
)


def page_answer(page: str) -> Answer:
    """Return what gives a page to whoever asks."""
    return lambda asked: ("text/html; charset=utf-8", page.encode())


class PageServer:
    """Serves a page and its document, and ``more`` by path; ``address`` is what a browser opens."""

    def __init__(self, page: str, document: bytes, port: int = 0, more: Mapping[str, Answer] | None = None) -> None:
        token = secrets.token_urlsafe(16)
        answers = {
            "/": page_answer(page),
            "/document": lambda asked: ("application/octet-stream", document),
            **(more or {}),
        }
        handler = type("Handler", (_Handler,), {"token": token, "answers": answers})
        try:
            self._server = ThreadingHTTPServer((HOST, port), handler)
        except OSError as error:
            raise ArenaError(f"port {port}: {error.strerror}; allowed: a free port, or 0 for any") from None
        self.address = f"http://{HOST}:{self._server.server_port}/?token={token}"

    def serve(self) -> None:
        """Serve until interrupted."""
        try:
            self._server.serve_forever()
        except KeyboardInterrupt:
            pass
        finally:
            self.close()

    def close(self) -> None:
        """Stop serving."""
        self._server.server_close()

    def shutdown(self) -> None:
        """Let ``serve`` of another thread end."""
        self._server.shutdown()


class _Handler(BaseHTTPRequestHandler):
    token: ClassVar[str]
    answers: ClassVar[dict[str, Answer]]
    server_version, sys_version = "arena", ""
    timeout = 30

    def do_GET(self) -> None:
        """Answer with a page, a document or what else is there."""
        parts = urlsplit(self.path)
        host = (self.headers.get("Host") or "").rpartition(":")[0]
        asked = dict(parse_qsl(parts.query))
        given = asked.get("token", "")
        if host not in (HOST, "localhost"):
            self._send_answer(403, "text/plain", b"this server knows no such host")
        elif not hmac.compare_digest(given.encode(), self.token.encode()):
            self._send_answer(
                403, "text/plain", b"the token is missing or wrong: open the address that `arena replay` printed"
            )
        elif parts.path not in self.answers:
            self._send_answer(404, "text/plain", b"no such page")
        else:
            try:
                self._send_answer(200, *self.answers[parts.path](asked))
            except ArenaError as error:  # what is asked for is not there, or cannot be read
                self._send_answer(404, "text/plain; charset=utf-8", str(error).encode())

    def _send_answer(self, status: int, kind: str, content: bytes) -> None:
        self.send_response(status)
        headers = {"Content-Type": kind, "Content-Length": str(len(content)), "Content-Security-Policy": POLICY}
        headers |= {"X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer", "Cache-Control": "no-store"}
        for name, value in headers.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *arguments: Any) -> None:
        """Say nothing of requests."""
