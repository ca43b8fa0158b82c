"""HTTP by hand: bytes no client library would send, and answers no library tidied up."""

import socket
from dataclasses import dataclass


@dataclass
class Answer:
    """status is 0 when the server closed without a word."""

    status: int
    headers: dict
    body: bytes


def connect(port: int, timeout: float = 120.0) -> socket.socket:
    return socket.create_connection(("127.0.0.1", port), timeout=timeout)


def exchange(port: int, request: bytes, timeout: float = 120.0) -> Answer:
    """Sends the bytes, then reads until the server closes, one whole answer is there, or
    `timeout` passes without a byte (an error: the server must answer or close)."""
    with connect(port, timeout) as connection:
        try:
            connection.sendall(request)
        except (BrokenPipeError, ConnectionResetError):
            pass  # It may refuse before the end of what it was sent; the answer still counts.
        return read_answer(connection)


def read_answer(connection: socket.socket) -> Answer:
    received = b""
    while b"\r\n\r\n" not in received:
        chunk = _receive(connection)
        if not chunk:
            return Answer(0, {}, received)
        received += chunk
    head, body = received.split(b"\r\n\r\n", 1)
    lines = head.decode("latin-1").split("\r\n")
    headers = {}
    for line in lines[1:]:
        name, _, value = line.partition(":")
        headers[name.strip().lower()] = value.strip()
    length = int(headers.get("content-length", "0"))
    while len(body) < length:
        chunk = _receive(connection)
        if not chunk:
            break
        body += chunk
    return Answer(int(lines[0].split(" ")[1]), headers, body)


def _receive(connection: socket.socket) -> bytes:
    try:
        return connection.recv(65536)
    except ConnectionResetError:
        return b""
