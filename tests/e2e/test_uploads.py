"""Large uploads: streamed to disk, memory independent of their size, limits kept."""

import hashlib
import io
import os
import zipfile

import pytest

from support import scenes
from support.api import ZIP, problem

CHUNK = 1 << 20


def padded_zip(path, mebibytes) -> str:
    """A box beside a stored file of random bytes that nothing reads; returns the digest."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as archive:
        for name, content in scenes.box_files(f"{mebibytes}").items():
            archive.writestr(name, content)
        with archive.open("padding.png", "w", force_zip64=True) as entry:
            for _ in range(mebibytes):
                entry.write(os.urandom(CHUNK))
    digest = hashlib.sha256()
    with open(path, "rb") as source:
        while block := source.read(CHUNK):
            digest.update(block)
    return digest.hexdigest()


@pytest.mark.measured
def test_memory_is_independent_of_the_upload(launch, tmp_path):
    api = launch()
    api.scene(scenes.box_zip())
    peaks = []
    for size in (16, 256):
        path = tmp_path / f"{size}.zip"
        digest = padded_zip(path, size)
        api.daemon.reset_peak()
        before = api.daemon.status_kib("VmRSS")
        with open(path, "rb") as source:
            assert api.upload(source, expect=(201,)).json()["id"] == digest
        peaks.append(api.daemon.status_kib("VmHWM") - before)
    assert peaks[1] <= peaks[0] + 8 * 1024, f"{peaks} KiB above the size before"
    assert peaks[1] <= 32 * 1024, f"{peaks} KiB above the size before"


@pytest.mark.measured
def test_memory_of_a_large_multipart(launch):
    api = launch()
    api.scene(scenes.box_zip())
    api.daemon.reset_peak()
    before = api.daemon.status_kib("VmRSS")
    api.upload_files(scenes.box_files() | {"padding.bin": os.urandom(96 * CHUNK)})
    assert api.daemon.status_kib("VmHWM") - before <= 32 * 1024


def test_an_upload_beyond_the_limit(launch):
    api = launch(options=["--max-upload-bytes", str(4 * CHUNK)])
    before = api.daemon.files()

    def endless():
        for _ in range(64):
            yield b"\0" * CHUNK

    for data in (b"\0" * (5 * CHUNK), endless()):
        try:
            problem(api.upload(data, expect=(413,)), 413, "payload_too_large")
        except OSError:
            pass  # The refusal may overtake the body; the client then sees a broken pipe.
        api.daemon.wait_for_files(before)
    assert api.get("/livez").status_code == 200


def test_an_upload_broken_off_leaves_nothing(launch):
    import socket
    import time

    api = launch()
    before = api.daemon.files()
    head = (f"POST /v1/scenes HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: {ZIP}\r\n"
            "Content-Length: 10000000\r\n\r\n").encode()
    for sent in (0, 100, 3_000_000):
        with socket.create_connection(("127.0.0.1", api.daemon.port)) as connection:
            connection.sendall(head + b"P" * sent)
            time.sleep(0.1)
    api.daemon.wait_for_files(before)


def test_the_same_upload_from_many_at_once(launch):
    from concurrent.futures import ThreadPoolExecutor

    api = launch()
    data = scenes.grid_zip(60)
    import requests

    def send(_):
        return requests.post(api.daemon.url + "/v1/scenes", data=io.BytesIO(data),
                             headers={"Content-Type": ZIP}, timeout=180)

    with ThreadPoolExecutor(4) as pool:
        answers = list(pool.map(send, range(8)))
    codes = [answer.status_code for answer in answers]
    assert set(codes) <= {200, 201, 429} and codes.count(201) == 1, codes
    assert len(api.json("/v1/scenes")["scenes"]) == 1
