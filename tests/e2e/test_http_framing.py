"""Requests no honest client sends. Each is refused, and none leaves a connection in doubt."""

import json
import socket
import time

import pytest

from support import raw_http
from support.api import problem
from support.daemon import SLOW
from support.patience import eventually

HOST = b"Host: 127.0.0.1\r\n"
JSON = b"Content-Type: application/json\r\n"


def post(*headers: bytes, body: bytes = b"", version: bytes = b"HTTP/1.1") -> bytes:
    lines = b"".join(header + b"\r\n" for header in headers)
    return b"POST /v1/jobs " + version + b"\r\n" + HOST + JSON + lines + b"\r\n" + body


CHUNKED = b"Transfer-Encoding: chunked"
SMUGGLED = b"GET /v1/jobs HTTP/1.1\r\n" + HOST + b"\r\n"
BAD_FRAMING = {
    "length and chunked": post(b"Content-Length: 5", CHUNKED, body=b"0\r\n\r\n" + SMUGGLED),
    "chunked and length": post(CHUNKED, b"Content-Length: 5", body=b"0\r\n\r\n" + SMUGGLED),
    "gzip, chunked": post(b"Transfer-Encoding: gzip, chunked", body=b"0\r\n\r\n"),
    "chunked twice": post(CHUNKED, CHUNKED, body=b"0\r\n\r\n"),
    "chunked, chunked": post(b"Transfer-Encoding: chunked, chunked", body=b"0\r\n\r\n"),
    "identity": post(b"Transfer-Encoding: identity", body=b""),
    "xchunked": post(b"Transfer-Encoding: xchunked", body=b"0\r\n\r\n"),
    "chunked with a tab": post(b"Transfer-Encoding: \x0bchunked", body=b"0\r\n\r\n"),
    "chunked in 1.0": post(CHUNKED, body=b"0\r\n\r\n", version=b"HTTP/1.0"),
    "trailer": post(CHUNKED, body=b"2\r\n{}\r\n0\r\nX-Late: 1\r\n\r\n"),
    "announced trailer": post(CHUNKED, b"Trailer: X-Late", body=b"0\r\nX-Late: 1\r\n\r\n"),
    "bad chunk size": post(CHUNKED, body=b"zz\r\n{}\r\n0\r\n\r\n"),
    "negative chunk size": post(CHUNKED, body=b"-1\r\n{}\r\n0\r\n\r\n"),
    "overflowing chunk size": post(CHUNKED, body=b"ffffffffffffffffff\r\n{}\r\n0\r\n\r\n"),
    "chunk without its end": post(CHUNKED, body=b"2\r\n{}XX0\r\n\r\n"),
    "two lengths": post(b"Content-Length: 2", b"Content-Length: 3", body=b"{}"),
    "same length twice": post(b"Content-Length: 2", b"Content-Length: 2", body=b"{}"),
    "length list": post(b"Content-Length: 2, 2", body=b"{}"),
    "negative length": post(b"Content-Length: -2", body=b"{}"),
    "signed length": post(b"Content-Length: +2", body=b"{}"),
    "hex length": post(b"Content-Length: 0x2", body=b"{}"),
    "huge length": post(b"Content-Length: 99999999999999999999999", body=b"{}"),
    "space before colon": post(b"Content-Length : 2", body=b"{}"),
    "folded header": post(b"X-A: 1\r\n 2", b"Content-Length: 2", body=b"{}"),
    "header without colon": post(b"nonsense", b"Content-Length: 2", body=b"{}"),
    "NUL in header": post(b"X-A: a\x00b", b"Content-Length: 2", body=b"{}"),
    "bare CR in header": post(b"X-A: a\rb", b"Content-Length: 2", body=b"{}"),
    "no host": b"GET /livez HTTP/1.1\r\n\r\n",
    "two hosts": b"GET /livez HTTP/1.1\r\n" + HOST + HOST + b"\r\n",
    "not HTTP": b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + b"\x00" * 64 + b"\r\n\r\n",
}


@pytest.mark.parametrize("name", BAD_FRAMING)
def test_bad_framing_is_refused_and_the_connection_closed(api, name):
    with raw_http.connect(api.daemon.port, 120 * SLOW) as connection:
        connection.sendall(BAD_FRAMING[name])
        answer = raw_http.read_answer(connection)
        assert answer.status in (400, 413), (answer.status, answer.body[:300])
        refusal = json.loads(answer.body)
        assert refusal["code"] in ("bad_request", "payload_too_large"), refusal
        assert answer.headers["content-type"] == "application/problem+json"
        rest = b""
        while True:  # Nothing that was smuggled in may be answered.
            try:
                chunk = connection.recv(65536)
            except ConnectionResetError:
                break
            if not chunk:
                break
            rest += chunk
        assert rest == b"", rest[:300]


BAD_TARGETS = [b"livez", b"*", b"/v1/../livez", b"/./livez", b"/%2e%2e/livez", b"/%", b"/%zz",
               b"/%00", b"/a%0d%0ab", b"/\x01", b"/v1/scenes/..%2f..%2fetc%2fpasswd",
               b"http://127.0.0.1/livez", b"//livez/../..", b"/..", b"/v1/jobs/%2e/image"]


@pytest.mark.parametrize("target", BAD_TARGETS, ids=repr)
def test_bad_targets(api, target):
    answer = raw_http.exchange(api.daemon.port, b"GET " + target + b" HTTP/1.1\r\n" + HOST + b"\r\n")
    assert answer.status in (400, 404), (answer.status, answer.body[:300])
    assert json.loads(answer.body)["code"] in ("bad_request", "invalid_parameter", "not_found")


def test_files_beside_the_page_stay_there(api):
    for target in (b"/assets/../../../../etc/passwd", b"/..%2f..%2f..%2fetc/passwd",
                   b"/%2e%2e/%2e%2e/etc/passwd", b"/etc/passwd", b"//etc/passwd"):
        answer = raw_http.exchange(api.daemon.port,
                                   b"GET " + target + b" HTTP/1.1\r\n" + HOST + b"\r\n")
        assert answer.status in (400, 404) and b"root:" not in answer.body


def test_long_heads_and_targets(api):
    port = api.daemon.port
    long_target = b"GET /" + b"a" * 5000 + b" HTTP/1.1\r\n" + HOST + b"\r\n"
    assert raw_http.exchange(port, long_target).status == 414
    one_header = b"GET /livez HTTP/1.1\r\n" + HOST + b"X-A: " + b"a" * 20000 + b"\r\n\r\n"
    assert raw_http.exchange(port, one_header).status == 431
    many = b"".join(b"X-%d: a\r\n" % i for i in range(4000))
    assert raw_http.exchange(port, b"GET /livez HTTP/1.1\r\n" + HOST + many + b"\r\n").status == 431
    endless = b"GET /livez HTTP/1.1\r\nX: " + b"a" * 4_000_000
    assert raw_http.exchange(port, endless).status in (0, 431)


def test_versions_and_methods(api):
    port = api.daemon.port
    assert raw_http.exchange(port, b"GET /livez HTTP/2.0\r\n" + HOST + b"\r\n").status in (400, 505)
    answer = raw_http.exchange(port, b"GET /livez HTTP/1.0\r\n" + HOST + b"\r\n")
    assert answer.status == 200 and answer.headers.get("connection", "close") == "close"
    for method in ("PATCH", "DELETE", "PUT"):
        refused = api.request(method, "/v1/jobs")
        problem(refused, 405, "method_not_allowed")
        assert {"GET", "POST"} <= {word.strip() for word in refused.headers["Allow"].split(",")}
    answer = raw_http.exchange(port, b"BREW /livez HTTP/1.1\r\n" + HOST + b"\r\n")
    assert answer.status in (400, 405, 501)


def test_keep_alive_and_pipelining(api):
    request = b"GET /livez HTTP/1.1\r\n" + HOST + b"\r\n"
    with raw_http.connect(api.daemon.port) as connection:
        for _ in range(3):
            connection.sendall(request)
            assert raw_http.read_answer(connection).status == 200
    with raw_http.connect(api.daemon.port) as connection:
        connection.sendall(request * 3)
        connection.shutdown(socket.SHUT_WR)
        received = b""
        while chunk := connection.recv(65536):
            received += chunk
    assert received.count(b"HTTP/1.1 200") == 3


def test_a_plain_chunked_request_is_welcome(api, samples):
    body = json.dumps({"scene": samples["box"], "width": 8, "height": 8,
                       "stop": {"samples": 1}}).encode()
    chunks = b"".join(b"%x\r\n%s\r\n" % (1, body[i:i + 1]) for i in range(len(body)))
    answer = raw_http.exchange(api.daemon.port, post(CHUNKED, body=chunks + b"0\r\n\r\n"))
    assert answer.status == 202, answer.body


def test_expect_continue(api):
    head = (b"POST /v1/scenes HTTP/1.1\r\n" + HOST +
            b"Content-Type: application/zip\r\nContent-Length: 4\r\nExpect: 100-continue\r\n\r\n")
    with raw_http.connect(api.daemon.port) as connection:
        connection.sendall(head)
        assert raw_http.read_answer(connection).status == 100
        connection.sendall(b"oops")
        assert raw_http.read_answer(connection).status == 422
    refused = head.replace(b"Content-Length: 4", b"Content-Length: 99999999999999")
    assert raw_http.exchange(api.daemon.port, refused).status == 413
    other = head.replace(b"100-continue", b"200-ok")
    assert raw_http.exchange(api.daemon.port, other).status == 417


@pytest.mark.measured
def test_a_slow_head_is_cut_off_after_ten_seconds(api):
    start = time.monotonic()
    with raw_http.connect(api.daemon.port) as connection:
        connection.settimeout(1)
        request, answer = b"GET /livez HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Slow: ", b""
        connection.sendall(request)
        while time.monotonic() - start < 60:  # One byte a second must not buy more time.
            try:
                chunk = connection.recv(65536)
                answer += chunk
                if not chunk:
                    break
            except socket.timeout:
                connection.sendall(b"a")
            except ConnectionResetError:
                break
        elapsed = time.monotonic() - start
    assert 8 <= elapsed <= 30, elapsed
    assert answer == b"" or b" 408 " in answer.split(b"\r\n")[0]


def test_hundreds_of_idle_connections_shut_nobody_out(launch):
    api = launch(options=["--max-connections", "64"])
    held = [socket.create_connection(("127.0.0.1", api.daemon.port)) for _ in range(200)]
    time.sleep(0.2)  # They are refused, or held; how many by now is all the same.
    for connection in held:
        connection.close()

    def served():
        try:
            return api.get("/livez").status_code == 200
        except Exception:  # A refusal by closing is allowed while the limit is reached.
            return False

    eventually(served)


@pytest.mark.parametrize("headers", [
    {"Origin": "http://evil.example"}, {"Origin": "null"}, {"Sec-Fetch-Site": "cross-site"},
    {"Origin": "https://127.0.0.1:8080"}, {"Origin": "http://localhost.evil.example"},
], ids=str)
def test_writes_from_another_origin_are_refused(api, samples, headers):
    job = {"scene": samples["box"], "width": 8, "height": 8, "stop": {"samples": 1}}
    problem(api.request("POST", "/v1/jobs", json=job, headers=headers), 403, "cross_origin")
    answer = api.request("DELETE", f"/v1/scenes/{samples['box']}", headers=headers)
    problem(answer, 403, "cross_origin")
    read = api.get("/v1/jobs", headers=headers)
    assert "Access-Control-Allow-Origin" not in read.headers


def test_writes_from_the_own_page_are_welcome(api, samples):
    origin = {"Origin": api.daemon.url, "Sec-Fetch-Site": "same-origin"}
    api.submit(samples["box"], headers=origin)


def test_a_foreign_host_name_is_refused(api):
    """DNS rebinding: the name of another site that now points to this machine."""
    for host in ("evil.example", "evil.example:80", "127.0.0.1.evil.example"):
        problem(api.get("/v1/jobs", headers={"Host": host}), 421, "host_not_allowed")
    assert api.get("/livez", headers={"Host": f"localhost:{api.daemon.port}"}).status_code == 200


def test_every_answer_names_its_request(api):
    answers = [api.get("/livez"), api.get("/nowhere"), api.get("/v1/jobs/x")]
    ids = [answer.headers["X-Request-Id"] for answer in answers]
    assert all(ids) and len(set(ids)) == 3
    assert answers[2].json().get("request", ids[2]) == ids[2]


def test_only_loopback_is_listened_on(api):
    """Every socket of the daemon in LISTEN state is bound to 127.0.0.1 or ::1."""
    loopback = {"0100007F", "00000000000000000000000001000000"}
    for table in ("tcp", "tcp6"):
        for line in open(f"/proc/net/{table}").read().splitlines()[1:]:
            address, port = line.split()[1].split(":")
            if line.split()[3] == "0A" and int(port, 16) == api.daemon.port:
                assert address in loopback
