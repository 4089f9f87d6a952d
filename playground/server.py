"""The server of the playground: one page and one address for work, on the loopback address, for those who have the token.

The only file that imports Starlette and uvicorn.
"""

from __future__ import annotations

import asyncio
import base64
import hashlib
import secrets
import socket
from collections.abc import AsyncIterator, Iterable
from contextlib import suppress
from types import FrameType
from typing import Any

import uvicorn
from starlette.applications import Starlette
from starlette.requests import ClientDisconnect, Request
from starlette.responses import HTMLResponse, PlainTextResponse, Response, StreamingResponse
from starlette.routing import Route

from ..data.scene import in_json
from ..sampling.program_source import Source
from ..semantics.store.errors import UsageError
from .json_views import Json
from .request import MOST_BYTES, PlayRequest, request_of
from .worker_pool import WorkProcess, process_context

HOST = "127.0.0.1"
AT_ONCE = 4
"""Pieces of work that are done at a time; others wait."""
END = b'{"kind": "end"}'
"""The last message of a process."""
LATE = 2.0
"""Seconds beyond the limit after which a process that does not tell of it itself is ended."""
LEAVING = 1
"""Seconds that answers may still take when the server ends."""


class Playground:
    """The server: the options of the programs, the token, and the processes that work."""

    def __init__(self, source: Source, page: str, door: str, token: str, port: int) -> None:
        self.source = source
        self.page, self.policy = page, policy_of(page)
        self.closed, self.closed_policy = door, policy_of(door)
        self.token = token
        self.hosts = {f"{HOST}:{port}", f"localhost:{port}"} | ({HOST, "localhost"} if port == 80 else set())
        self.context = process_context()
        self.running: dict[tuple[str, str], WorkProcess] = {}
        self.turns = asyncio.Semaphore(AT_ONCE)
        self.ended = False

    def app(self) -> Starlette:
        """Return the web application."""
        return Starlette(routes=[
            Route("/{token}/", self.show, methods=["GET"]), Route("/{token}/work", self.work, methods=["POST"]),
            Route("/{rest:path}", self.refuse, methods=["GET", "POST", "PUT", "DELETE", "PATCH", "OPTIONS"]),
        ])  # fmt: skip

    def problem(self, request: Request) -> Response | None:
        """The answer to a request that is none of ours: from another page, for another host, without the token."""
        if request.headers.get("host", "") not in self.hosts:
            return self.secured(PlainTextResponse("this server answers to 127.0.0.1 only", 400))
        token = request.path_params.get("token", "")
        if not secrets.compare_digest(token.encode("utf-8", "replace"), self.token.encode()):
            return self.door()
        origin = request.headers.get("origin")
        if origin is not None and origin not in {f"http://{host}" for host in self.hosts}:
            return self.secured(PlainTextResponse("another page may not ask this server", 403))
        return None

    async def show(self, request: Request) -> Response:
        """Answer with the page."""
        return self.problem(request) or self.secured(HTMLResponse(self.page), self.policy)

    async def refuse(self, request: Request) -> Response:
        """There is nothing at any other address."""
        return self.problem(request) or self.door()

    def door(self) -> Response:
        """Return the page for visitors without a token; a browser that once had it finds its way back."""
        return self.secured(HTMLResponse(self.closed, 403), self.closed_policy)

    def secured(self, response: Response, policy: str = "default-src 'none'; frame-ancestors 'none'") -> Response:
        """A response that no other page can frame, read or keep, and that loads nothing from elsewhere."""
        response.headers.update({
            "Content-Security-Policy": policy, "X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer", "X-Frame-Options": "DENY",
            "Cross-Origin-Opener-Policy": "same-origin", "Cross-Origin-Resource-Policy": "same-origin", "Cache-Control": "no-store",
        })  # fmt: skip
        return response

    async def work(self, request: Request) -> Response:
        """The answer to a piece of work: lines of JSON, as they are found."""
        problem = self.problem(request)
        if problem is not None:
            return problem
        if request.headers.get("content-type", "") != "application/json" or request.headers.get("sec-fetch-site", "same-origin") != "same-origin":
            return self.secured(PlainTextResponse("work is asked for as JSON, by the page", 415))
        try:
            body = await body_of(request)
            asked = request_of(body, self.source)
        except UsageError as wrong:
            return self.secured(PlainTextResponse(wrong.message, 400))
        except ClientDisconnect:
            return Response(status_code=400)
        return self.secured(StreamingResponse(self.lines(asked), media_type="application/x-ndjson"))

    async def lines(self, asked: PlayRequest) -> AsyncIterator[bytes]:
        """The messages of the process that does a piece of work, which replaces an earlier one in its slot."""
        key = (asked.page, asked.slot)
        if self.ended:
            return
        job = WorkProcess(self.context, asked)
        before = self.running.get(key)
        if before is not None:
            before.replaced = True
            before.stop()
        self.running[key] = job
        try:
            async with self.turns:
                await asyncio.to_thread(job.start)
                async for data in self.heard(job):
                    yield data
        finally:
            job.stop()
            if self.running.get(key) is job:
                del self.running[key]

    async def heard(self, job: WorkProcess) -> AsyncIterator[bytes]:
        """The messages of a process, and how it ended if it does not tell."""
        limit = job.asked.seconds
        clock = None if limit is None else asyncio.get_running_loop().call_later(limit + LATE, job.be_late)
        try:
            data = b""
            while not job.stopped and data != END:
                data = await asyncio.to_thread(job.receive)
                if not data:
                    break
                yield data + b"\n"
        finally:
            if clock is not None:
                clock.cancel()
        if job.replaced:
            yield line({"kind": "replaced"})
        elif self.ended:
            yield line({"kind": "over", "message": "The server was ended."})
        elif job.late:
            yield line({"kind": "over", "message": f"The time for one answer, {limit:g} s, is over; --limit-seconds allows more."})
        elif data != END:
            yield line({"kind": "over", "message": crash_message(await asyncio.to_thread(job.wait))})

    def end(self) -> None:
        """End all processes, and start no more."""
        self.ended = True
        for job in list(self.running.values()):
            job.stop()


def crash_message(code: int | None) -> str:
    """Return the message for a process that has ended without an answer."""
    how = f"was ended by signal {-code}" if code is not None and code < 0 else f"ended with exit code {code}"
    return f"The process that ran the program {how}. The server goes on; a program without --trust must not be able to do this: please report it."


def line(found: Json) -> bytes:
    """A message of the server itself."""
    return in_json(found).encode() + b"\n"


async def body_of(request: Request) -> bytes:
    """The body of a request. Raises `UsageError` where it is too long."""
    body = b""
    async for part in request.stream():
        body += part
        if len(body) > MOST_BYTES:
            raise UsageError(f"the program is too long: a request has at most {MOST_BYTES:,} bytes")
    return body


def policy_of(page: str) -> str:
    """The policy of a page: it runs its own script and style, known by their hashes, asks this server, and loads nothing else."""
    scripts, styles = (hashes(page, f"<{tag}>", f"</{tag}>") for tag in ("script", "style"))
    return (
        f"default-src 'none'; script-src {scripts}; style-src {styles}; img-src data: blob:; connect-src 'self'; base-uri 'none'; "
        "form-action 'none'; frame-ancestors 'none'; require-trusted-types-for 'script'; trusted-types 'none'"
    )


def hashes(page: str, begin: str, end: str) -> str:
    """The hashes of the parts of a page between two marks, as a policy has them."""
    parts: Iterable[str] = (part.partition(end)[0] for part in page.split(begin)[1:])
    found = [f"'sha256-{base64.b64encode(hashlib.sha256(part.encode()).digest()).decode()}'" for part in parts]
    return " ".join(found) or "'none'"


def bind_socket(port: int, *, otherwise: bool) -> socket.socket:
    """A socket on the loopback address; on another port if this one is taken and `otherwise`. Raises `UsageError`."""
    found = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    found.setsockopt(socket.SOL_SOCKET, getattr(socket, "SO_EXCLUSIVEADDRUSE", socket.SO_REUSEADDR), 1)
    try:
        found.bind((HOST, port))
        found.listen()
    except OSError as problem:
        found.close()
        if otherwise:
            return bind_socket(0, otherwise=False)
        raise UsageError(f"port {port} cannot be used: {problem.strerror or problem}", hint="leave --port out, and a free one is taken") from None
    return found


MOST_CONNECTIONS, MOST_IDLE = 512, 32
"""Connections at a time, and how many of them may be open for long without a request."""
SHORTLY = 10
"""Tenths of a second for which any connection may be."""


class PlayServer(uvicorn.Server):
    """Ends the processes that work as soon as the server is told to end, so that nobody waits for them; and connections on which nobody asks."""

    def __init__(self, config: uvicorn.Config, playground: Playground) -> None:
        super().__init__(config)
        self.playground = playground
        self.idle: dict[Any, int] = {}

    async def on_tick(self, counter: int) -> bool:
        """Ten times a second: close the connections that have been idle longest, if there are too many, so that there is room for others."""
        found = {one for one in self.server_state.connections if one.cycle is None or one.cycle.response_complete}  # type: ignore[union-attr]
        self.idle = {one: self.idle.get(one, counter) for one in (*self.idle, *found) if one in found}
        for one, since in [*self.idle.items()][: max(0, len(self.idle) - MOST_IDLE)]:
            if counter - since > SHORTLY:
                one.transport.close()
        return await super().on_tick(counter)

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """A signal to end."""
        self.playground.end()
        super().handle_exit(sig, frame)


def serve_playground(playground: Playground, door: socket.socket) -> None:
    """Answer until Ctrl-C, or until the process is told to end; then no process is left."""
    config = uvicorn.Config(
        playground.app(), log_level="error", access_log=False, server_header=False, date_header=False, lifespan="off", ws="none", loop="asyncio",
        http="h11", timeout_graceful_shutdown=LEAVING, limit_concurrency=MOST_CONNECTIONS,
    )  # fmt: skip
    with suppress(KeyboardInterrupt):
        try:
            PlayServer(config, playground).run(sockets=[door])
        finally:
            playground.end()
            door.close()
