"""Messages between a program and its worker, told from anything else that gets into the pipe.

A message is a token that only the two know, its length, and that many bytes of pickle. The
program's end never waits: a worker that is stopped in the middle of a message, or whose
forked children write too, holds nobody up.
"""

from __future__ import annotations

import os
import pickle
import struct
from collections.abc import Iterator
from multiprocessing.connection import Connection
from typing import Any

#: Bytes that are read or written at a time.
CHUNK = 1 << 20

#: Chunks that are read from one worker before the others get their turn.
TURN = 64

TOKEN_BYTES = 16
_HEADER = struct.Struct(f"<{TOKEN_BYTES}sQ")
_WINDOWS = os.name == "nt"


class Garbled(Exception):
    """What came through the pipe is no message."""


class Channel:
    """One end of a pipe for messages.

    waits  True: sending and receiving wait for the other end, as a worker does
    """

    def __init__(self, connection: Connection, token: bytes, waits: bool):
        self.connection, self.token, self.waits = connection, token, waits
        self.closed = False
        self._received, self._unsent = bytearray(), memoryview(b"")
        if not waits and not _WINDOWS:
            os.set_blocking(connection.fileno(), False)

    def send(self, message: Any) -> None:
        """Send, or keep for `flush` what finds no room in the pipe; `OSError` when it is closed."""
        content = pickle.dumps(message, pickle.HIGHEST_PROTOCOL)
        header = _HEADER.pack(self.token, len(content))
        self._unsent = memoryview(b"".join((self._unsent, header, content)))
        self.flush()

    def flush(self) -> bool:
        """Send what is left; False when some of it still finds no room."""
        while self._unsent:
            written = self._write(self._unsent[:CHUNK])
            if not written:
                return False
            self._unsent = self._unsent[written:]
        return True

    def receive(self) -> Iterator[Any]:
        """The messages that have arrived whole; `Garbled` for anything else.

        A channel that `waits` gives one at least. `closed` says that no more can come.
        """
        yield from self._whole()
        for _ in range(TURN):
            data = self._read()
            if not data:
                self.closed = data is not None
                return
            self._received += data
            found = False
            for message in self._whole():
                found = True
                yield message
            if found and self.waits:
                return

    def _whole(self) -> Iterator[Any]:
        while len(self._received) >= _HEADER.size:
            token, length = _HEADER.unpack_from(self._received)
            if token != self.token:
                raise Garbled("sent something that is no answer")
            end = _HEADER.size + length
            if len(self._received) < end:
                return
            content = bytes(self._received[_HEADER.size : end])
            del self._received[:end]
            try:
                message = pickle.loads(content)
            except Exception as error:  # unpickling may raise anything
                raise Garbled(f"sent an answer that cannot be read ({error})") from error
            yield message

    def _read(self) -> bytes | None:
        """What has arrived; None when nothing has, empty when the other end is closed."""
        try:
            if not _WINDOWS:
                return os.read(self.connection.fileno(), CHUNK)
            if not self.waits and not self.connection.poll():
                return None
            return self.connection.recv_bytes()
        except BlockingIOError:
            return None
        except (EOFError, OSError):
            return b""

    def _write(self, data: memoryview) -> int:
        try:
            if not _WINDOWS:
                return os.write(self.connection.fileno(), data)
            self.connection.send_bytes(data)
            return len(data)
        except BlockingIOError:
            return 0

    def close(self) -> None:
        """Close this end."""
        self.connection.close()
