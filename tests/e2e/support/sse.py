"""A reader of server-sent events over a plain socket, whose pace the test decides."""

import json
import socket
import time
from dataclasses import dataclass


@dataclass
class Event:
    id: str
    kind: str
    data: dict
    arrived: float  # time.monotonic() seconds


class EventStream:
    """One subscription. `events()` yields until the server closes the stream."""

    def __init__(self, port: int, path: str, last_event_id=None, receive_buffer=None, timeout=180.0):
        self.connection = socket.socket()
        if receive_buffer:
            self.connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        self.connection.settimeout(timeout)
        self.connection.connect(("127.0.0.1", port))
        lines = [f"GET {path} HTTP/1.1", f"Host: 127.0.0.1:{port}", "Accept: text/event-stream"]
        if last_event_id is not None:
            lines.append(f"Last-Event-ID: {last_event_id}")
        self.connection.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
        self.pending = b""
        self.comments = 0
        self.headers = None
        self.status = None
        self._chunked = False
        self._body = b""
        self._ended = False

    def close(self):
        self.connection.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def read_head(self):
        while b"\r\n\r\n" not in self.pending:
            if not self._fill():
                raise AssertionError(f"closed before the head ended: {self.pending!r}")
        head, self.pending = self.pending.split(b"\r\n\r\n", 1)
        lines = head.decode("latin-1").split("\r\n")
        self.status = int(lines[0].split(" ")[1])
        self.headers = {k.strip().lower(): v.strip()
                        for k, _, v in (line.partition(":") for line in lines[1:])}
        self._chunked = self.headers.get("transfer-encoding") == "chunked"

    def events(self):
        if self.headers is None:
            self.read_head()
        assert self.status == 200, (self.status, self.pending)
        while True:
            event = self._next()
            if event is None:
                return
            yield event

    def last(self) -> Event:
        *_, final = self.events()
        return final

    def _next(self):
        while True:
            self._unchunk()
            block, separator, rest = self._body.replace(b"\r\n", b"\n").partition(b"\n\n")
            if separator:
                self._body = rest
                event = self._parse(block.decode())
                if event is not None:
                    return event
                continue
            if self._ended or not self._fill():
                assert not self._body.strip(), f"stream ended inside an event: {self._body!r}"
                return None

    def _parse(self, block: str):
        fields = {"id": None, "event": "message", "data": []}
        for line in block.split("\n"):
            if line.startswith(":"):
                self.comments += 1
                continue
            name, _, value = line.partition(":")
            value = value[1:] if value.startswith(" ") else value
            if name == "data":
                fields["data"].append(value)
            elif name in fields:
                fields[name] = value
        if not fields["data"]:
            return None
        text = "\n".join(fields["data"])
        return Event(fields["id"], fields["event"], json.loads(text), time.monotonic())

    def _fill(self) -> bool:
        chunk = self.connection.recv(65536)
        self.pending += chunk
        return bool(chunk)

    def _unchunk(self):
        if not self._chunked:
            self._body += self.pending
            self.pending = b""
            return
        while not self._ended:
            size_line, separator, rest = self.pending.partition(b"\r\n")
            if not separator:
                return
            size = int(size_line.split(b";")[0], 16)
            if len(rest) < size + 2:
                return
            assert rest[size : size + 2] == b"\r\n", "chunk without its line end"
            self._body += rest[:size]
            self.pending = rest[size + 2 :]
            self._ended = size == 0
