"""``/api/live``: a websocket that tells how the experiments stand, whenever that changes."""

from __future__ import annotations

import asyncio
import json
from contextlib import suppress
from typing import Any

from fastapi import APIRouter, WebSocket
from starlette.websockets import WebSocketDisconnect

from arena_studio.experiments.experiments import Experiments

EVERY = 0.5  # s between two looks
MOST = 20  # pages that are told


def make_router(experiments: Experiments) -> APIRouter:
    """Return the route of the websocket."""
    routes = APIRouter()
    listening: set[WebSocket] = set()

    @routes.websocket("/api/live")
    async def live(socket: WebSocket) -> None:
        """Tell until the page goes away; what it says is not listened to."""
        if len(listening) >= MOST:
            await socket.close(1013)
            return
        await socket.accept()
        listening.add(socket)
        telling = asyncio.create_task(_send_states(socket, experiments))
        try:
            while (await socket.receive())["type"] != "websocket.disconnect":
                pass
        finally:
            listening.discard(socket)
            telling.cancel()
            # RuntimeError: it was closed meanwhile
            with suppress(asyncio.CancelledError, WebSocketDisconnect, RuntimeError):
                await telling

    return routes


async def _send_states(socket: WebSocket, experiments: Experiments) -> None:
    before: Any = None
    while True:
        now = json.dumps({"experiments": await asyncio.to_thread(experiments.all)})
        if now != before:
            await socket.send_text(now)
            before = now
        await asyncio.sleep(EVERY)
