"""Requests to a UM-Bridge server: one connection each, with a time limit and retries."""

from __future__ import annotations

import json
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from http.client import HTTPConnection, HTTPException, HTTPSConnection
from typing import Any
from urllib.parse import urlsplit

from surrogate.errors import SolverError

#: Largest answer that is read, bytes; seconds before the first retry, doubled each time.
LARGEST, PAUSE = 2**30, 0.5


class Unreachable(RuntimeError):
    """The server cannot be reached, or broke: not an answer of the model."""


@dataclass(frozen=True)
class Client:
    """A model on a server.

    url      such as "http://localhost:4242"
    model    the model's name on the server
    config   what the model is told besides its inputs
    timeout  seconds that one answer may take
    retries  how often a request is repeated when the server cannot be reached or breaks
    """

    url: str
    model: str
    config: Mapping[str, Any] = field(default_factory=dict)
    timeout: float | None = None
    retries: int = 2

    def models(self) -> list[str]:
        """Names of the models on the server; raises `Unreachable`."""
        info = self._ask("GET", "/Info", None)
        if info.get("protocolVersion") != 1.0:
            raise Unreachable(f"{self.url} speaks UM-Bridge {info.get('protocolVersion')}, not 1.0")
        return [str(name) for name in info.get("models", [])]

    def sizes(self) -> tuple[list[int], list[int]]:
        """Numbers in each vector that goes in and out."""
        asked = {"name": self.model, "config": dict(self.config)}
        return (
            self._ask("POST", "/InputSizes", asked)["inputSizes"],
            self._ask("POST", "/OutputSizes", asked)["outputSizes"],
        )

    def evaluate(self, vectors: list[list[float]]) -> list[list[float]]:
        """The model's answer; `SolverError` when it has none, `Unreachable` when it breaks."""
        asked = {"name": self.model, "input": vectors, "config": dict(self.config)}
        found: list[list[float]] = self._ask("POST", "/Evaluate", asked)["output"]
        return found

    def _ask(self, method: str, path: str, body: Any) -> dict[str, Any]:
        pause = PAUSE
        for _ in range(self.retries):
            try:
                return self._once(method, path, body)
            except Unreachable:
                time.sleep(pause)
                pause *= 2.0
        return self._once(method, path, body)

    def _once(self, method: str, path: str, body: Any) -> dict[str, Any]:
        at = urlsplit(self.url)
        kind = HTTPSConnection if at.scheme == "https" else HTTPConnection
        try:
            connection = kind(at.hostname or "", at.port, timeout=self.timeout)
            try:
                content = None if body is None else json.dumps(body)
                headers = {"Content-Type": "application/json"} if content else {}
                connection.request(method, at.path.rstrip("/") + path, content, headers)
                reply = connection.getresponse()
                status, answer = reply.status, reply.read(LARGEST)
            finally:
                connection.close()
        except TimeoutError:
            raise Unreachable(f"{self.url} gave no answer within {self.timeout:g} s") from None
        except (OSError, HTTPException) as error:
            raise Unreachable(f"{self.url} cannot be reached: {error}") from None
        return self._read(status, answer)

    def _read(self, status: int, answer: bytes) -> dict[str, Any]:
        try:
            found = json.loads(answer)
        except (ValueError, RecursionError):
            raise Unreachable(f"{self.url} answered {status} and no JSON") from None
        if not isinstance(found, dict):
            raise Unreachable(f"{self.url} answered {status} and no JSON object")
        if "error" in found or status >= 400:
            error = found.get("error")
            told = error if isinstance(error, dict) else {"message": f"status {status}"}
            sentence = f"{told.get('type', 'error')}: {told.get('message', '')}"
            raise (SolverError if status < 500 else Unreachable)(sentence)
        return found
