"""Who may ask: a token in the address becomes a cookie; the host, where a page comes from, and the size of
what is sent are checked.
"""

from __future__ import annotations

import hmac
from collections.abc import Mapping
from dataclasses import dataclass, field
from http.cookies import CookieError, SimpleCookie
from pathlib import Path
from urllib.parse import parse_qs

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from arena_core import ArenaError
from arena_core.files import reading_within
from arena_studio.errors import Refused, TooLarge, status_of
from arena_studio.signed_addresses import SignedAddresses

READING = ("GET", "HEAD")  # methods that signed addresses answer
LOOPBACK = frozenset({"127.0.0.1", "localhost", "[::1]"})
BODY = 2_000_000  # bytes of a request
LARGE_BODIES: Mapping[str, int] = {"/api/maps": 140_000_000}  # images of maps, and what base64 adds to them
COMMON = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}


@dataclass(frozen=True, slots=True)
class Access:
    """The token that pages must know, the names that the server answers to (None: any), and the policy of its own
    pages.

    ``policy`` is the Content-Security-Policy of answers that do not have one of their own.
    """

    token: str
    hosts: frozenset[str] | None
    policy: str
    cookie: str = field(default="arena_studio")

    def cookie_name(self, host: str) -> str:
        """Return the cookie's name, which has the port in it: browsers keep cookies
        of all ports of a machine together.
        """
        return f"{self.cookie}_{host.rpartition(':')[2]}" if ":" in host else self.cookie

    def check(self, scope: Scope) -> bool:
        """Raise Refused for a request that may not be answered; return whether it brought the token in its address."""
        headers = Headers(scope=scope)
        host = headers.get("host", "")
        if self.hosts is not None and _host_name(host) not in self.hosts:
            raise Refused("this server knows no such host; open the address that `arena studio` printed")
        self._check_origin(scope, headers, host)
        given = _query_token(scope) if scope["type"] == "http" and scope["path"] == "/" else ""
        if given and hmac.compare_digest(given.encode(), self.token.encode()):
            return True
        if scope["type"] == "http" and scope["method"] in READING and SignedAddresses(self.token).allows(scope["path"]):
            return False
        if not hmac.compare_digest(_read_cookie(headers, self.cookie_name(host)).encode(), self.token.encode()):
            raise Refused("the token is missing or wrong: open the address that `arena studio` printed")
        return False

    def _check_origin(self, scope: Scope, headers: Headers, host: str) -> None:
        """Refuse what a page from elsewhere sends: browsers say where it comes from, and always so for websockets."""
        origin = headers.get("origin")
        if origin is None and scope["type"] == "http":
            return
        if origin not in (f"http://{host}", f"https://{host}"):
            raise Refused("the request comes from another page")


class AccessMiddleware:
    """Answers requests that may not be served, counts the bytes of bodies, and adds headers to every answer.

    Whatever answers the others reads no file outside ``root``, the project folder.
    """

    def __init__(self, app: ASGIApp, access: Access, root: Path) -> None:
        self._app = app
        self._access = access
        self._root = root

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request or websocket."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        try:
            fresh = self._access.check(scope)
            limit = _body_limit(scope)
            _check_length(scope, limit)
        except (Refused, TooLarge) as error:
            await self._reject_request(error, scope, receive, send)
            return
        with reading_within(self._root):
            await self._app(scope, _count_body(receive, limit), self._with_headers(scope, send, fresh=fresh))

    async def _reject_request(self, error: ArenaError, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 1008, "reason": "not allowed"})
            return
        answer = JSONResponse({"error": str(error)}, status_of(error))
        await answer(scope, receive, self._with_headers(scope, send, fresh=False))

    def _with_headers(self, scope: Scope, send: Send, *, fresh: bool) -> Send:
        """Return ``send`` with the headers of every answer, and the cookie where the token came in the address."""

        async def sender(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in {
                    **COMMON,
                    "Content-Security-Policy": self._access.policy,
                    "Cache-Control": "no-cache",
                }.items():
                    headers.setdefault(name, value)
                if fresh:
                    name = self._access.cookie_name(Headers(scope=scope).get("host", ""))
                    headers.append("Set-Cookie", f"{name}={self._access.token}; HttpOnly; SameSite=Strict; Path=/")
            await send(message)

        return sender


def _count_body(receive: Receive, limit: int) -> Receive:
    """Return ``receive`` that raises TooLarge once a body without a stated length has more than ``limit`` bytes."""
    seen = 0

    async def receiver() -> Message:
        nonlocal seen
        message = await receive()
        seen += len(message.get("body", b""))
        if seen > limit:
            raise _too_large(limit)
        return message

    return receiver


def _check_length(scope: Scope, limit: int) -> None:
    length = Headers(scope=scope).get("content-length", "0")
    if length.isdecimal() and int(length) > limit:
        raise _too_large(limit)


def _body_limit(scope: Scope) -> int:
    return next((limit for start, limit in LARGE_BODIES.items() if scope["path"].startswith(start)), BODY)


def _too_large(limit: int) -> TooLarge:
    return TooLarge(f"the request has more than {limit} bytes; allowed: up to that")


def _host_name(host: str) -> str:
    """Return a host without its port."""
    return host if host.endswith("]") else host.rpartition(":")[0] or host


def _query_token(scope: Scope) -> str:
    words: str = scope["query_string"].decode("latin-1")
    return parse_qs(words).get("token", [""])[0]


def _read_cookie(headers: Headers, name: str) -> str:
    try:
        found = SimpleCookie(headers.get("cookie", ""))
    except CookieError:
        return ""
    return str(found[name].value) if name in found else ""
