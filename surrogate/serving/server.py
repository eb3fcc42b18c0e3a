"""The HTTP server: reads requests within limits and writes what `protocol.answer` says."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Mapping
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from surrogate.errors import StudyError
from surrogate.serving.protocol import Model, Reply, answer

#: Largest body of a request, bytes; seconds that one may take to arrive; clients at once.
LARGEST, PATIENCE, CLIENTS = 16 * 2**20, 30.0, 64
LOOPBACK = "127.0.0.1"


class Server(ThreadingHTTPServer):
    """Serves `models` by name. Answers are computed one at a time unless `parallel`.

    Raises `StudyError` when the port cannot be had.
    """

    daemon_threads = True
    request_queue_size = 128

    def __init__(
        self,
        models: Mapping[str, Model],
        port: int = 4242,
        host: str = LOOPBACK,
        parallel: int = 1,
    ):
        self.models = models
        self._turns = threading.Semaphore(parallel)
        self._clients = threading.BoundedSemaphore(CLIENTS)
        try:
            super().__init__((host, port), _Handler)
        except (OSError, OverflowError) as error:
            raise StudyError(f"port {port} of {host} cannot be had: {error}") from None

    def answer(self, path: str, body: Any) -> Reply:
        """The answer to a request, when it is its turn."""
        if path != "/Evaluate" and "Apply" not in path and path != "/Gradient":
            return answer(self.models, path, body)
        with self._turns:
            return answer(self.models, path, body)

    def process_request(self, request: Any, client_address: Any) -> None:
        """A thread for each client, up to `CLIENTS`; one more waits until another is done."""
        self._clients.acquire()
        super().process_request(request, client_address)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """Serve one client to its end."""
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._clients.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A client that went away is no news."""


class _Handler(BaseHTTPRequestHandler):
    server: Server
    protocol_version = "HTTP/1.1"
    timeout = PATIENCE

    def do_GET(self) -> None:
        self._write(self.server.answer(_path(self.path), None))

    def do_POST(self) -> None:
        length = self.headers.get("Content-Length", "")
        if not (length.isascii() and length.isdigit()):
            self._refuse(411, "the request does not tell its length")
        elif len(length) > 12 or int(length) > LARGEST:
            self._refuse(413, f"the request is larger than {LARGEST} bytes")
        else:
            content = self._read(int(length))
            if content is None:
                self._refuse(408, f"the request did not arrive within {PATIENCE:g} s")
            else:
                self._answer(content)

    def _read(self, length: int) -> bytes | None:
        """The body; None when it does not arrive in time, however slowly it drips."""
        until, parts = time.monotonic() + PATIENCE, []
        while length and time.monotonic() < until:
            part = self.rfile.read1(min(length, 2**16))
            if not part:
                return None
            parts.append(part)
            length -= len(part)
        return None if length else b"".join(parts)

    def _answer(self, content: bytes) -> None:
        try:
            body = json.loads(content)
        except (ValueError, RecursionError):
            self._refuse(400, "the request is no JSON", close=False)
        else:
            self._write(self.server.answer(_path(self.path), body))

    def _refuse(self, status: int, sentence: str, close: bool = True) -> None:
        self.close_connection = self.close_connection or close
        self._write(Reply(status, {"error": {"type": "InvalidInput", "message": sentence}}))

    def _write(self, reply: Reply) -> None:
        content = json.dumps(reply.body).encode()
        self.send_response(reply.status)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(content)))
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *args: Any) -> None:
        """Nothing is logged: requests of a sampler are many."""


def _path(raw: str) -> str:
    return "/" + raw.split("?")[0].strip("/")
