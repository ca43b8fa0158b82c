"""Uploads that must not work: each gets a 4xx that names what and where, and leaves nothing."""

import io
import json
import stat
import struct
import zipfile

import pytest

from support import scenes
from support.api import GLB, ZIP, problem
from support.scenes import BOX_MTL, BOX_OBJ, box_zip, glb_of, triangle_glb, zip_of


def with_obj(text) -> bytes:
    return zip_of({"a.obj": text})


def with_sidecar(value) -> bytes:
    text = value if isinstance(value, (str, bytes)) else json.dumps(value)
    return zip_of({"box.obj": BOX_OBJ, "box.mtl": BOX_MTL, "raykiln.json": text})


def symlink_zip() -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        entry = zipfile.ZipInfo("a.obj")
        entry.external_attr = (stat.S_IFLNK | 0o777) << 16
        archive.writestr(entry, "/etc/passwd")
    return buffer.getvalue()


def bomb_zip() -> bytes:
    """512 MiB of line ends in half a megabyte."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        with archive.open("a.obj", "w", force_zip64=True) as entry:
            for _ in range(512):
                entry.write(b"\n" * (1 << 20))
    return buffer.getvalue()


def many_entries_zip() -> bytes:
    return zip_of({f"{i}.mtl": "" for i in range(20000)} | {"a.obj": BOX_OBJ})


def repeated_name_zip() -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        archive.writestr("a.obj", BOX_OBJ)
        with pytest.warns(UserWarning):
            archive.writestr("a.obj", "v 0 0 0\n")
    return buffer.getvalue()


def encrypted_zip() -> bytes:
    data = bytearray(zip_of({"a.obj": BOX_OBJ}))
    for signature, offset in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        data[data.index(signature) + offset] |= 1
    return bytes(data)


def wrong_crc_zip() -> bytes:
    data = bytearray(zip_of({"a.obj": BOX_OBJ}, zipfile.ZIP_STORED))
    data[data.index(b"v -1 -1 -1")] ^= 1
    return bytes(data)


WHOLE = box_zip("hostile")
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
SCENE_CODES = ("scene_invalid", "scene_empty", "scene_unsupported", "scene_too_large")
ARCHIVE_CODES = ("archive_invalid",)
# name: (bytes, codes that may answer, what `where` or `detail` must mention)
ZIPS = {
    "empty body": (b"", ARCHIVE_CODES, ""),
    "not a zip": (b"hello, this is no zip" * 10, ARCHIVE_CODES, ""),
    "zip without entries": (zip_of({}), ("archive_invalid", "scene_unsupported", "scene_empty"), ""),
    "cut in the directory": (WHOLE[:-10], ARCHIVE_CODES, ""),
    "cut in an entry": (WHOLE[: len(WHOLE) // 3], ARCHIVE_CODES, ""),
    "damaged middle": (WHOLE[:60] + bytes(40) + WHOLE[100:], ARCHIVE_CODES + SCENE_CODES, ""),
    "wrong CRC": (wrong_crc_zip(), ARCHIVE_CODES, "a.obj"),
    "encrypted": (encrypted_zip(), ARCHIVE_CODES, ""),
    "traversal": (zip_of({"../../evil.obj": BOX_OBJ}), ("unsafe_name",), "evil.obj"),
    "traversal inside": (zip_of({"a/../../evil.obj": BOX_OBJ}), ("unsafe_name",), "evil.obj"),
    "absolute": (zip_of({"/etc/evil.obj": BOX_OBJ}), ("unsafe_name",), "evil.obj"),
    "backslashes": (zip_of({"..\\evil.obj": BOX_OBJ}), ("unsafe_name",), "evil.obj"),
    "control character": (zip_of({"a\x07.obj": BOX_OBJ}), ("unsafe_name",), ""),
    "endless name": (zip_of({"a" * 3000 + ".obj": BOX_OBJ}), ("unsafe_name",), ""),
    "symbolic link": (symlink_zip(), ("unsafe_name", "archive_invalid"), "a.obj"),
    "repeated name": (repeated_name_zip, ("unsafe_name", "archive_invalid"), "a.obj"),
    "bomb": (bomb_zip, ("archive_too_large",), ""),
    "too many entries": (many_entries_zip, ("archive_too_large",), ""),
    "no root file": (zip_of({"a.mtl": BOX_MTL}), ("scene_unsupported",), ""),
    "two root files": (zip_of({"a.obj": BOX_OBJ, "b.obj": BOX_OBJ}), ("scene_unsupported",), ""),
    "no triangles": (with_obj("v 0 0 0\n"), ("scene_empty",), ""),
    "empty obj": (with_obj(""), ("scene_empty",), ""),
    "only flat triangles": (with_obj("v 0 0 0\nv 1 0 0\nf 1 2 2\n"), ("scene_empty",), ""),
    "NaN vertex": (with_obj("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"), ("scene_invalid",), "a.obj:2"),
    "infinite vertex": (with_obj("v 0 0 0\nv inf 0 0\nv 0 1 0\nf 1 2 3\n"), ("scene_invalid",), "a.obj:2"),
    "far vertex": (with_obj("v 0 0 0\nv 1e300 0 0\nv 0 1 0\nf 1 2 3\n"), ("scene_invalid",), "a.obj:2"),
    "overflowing vertex": (with_obj("v 0 0 0\nv 1e999 0 0\nv 0 1 0\nf 1 2 3\n"), ("scene_invalid",), "a.obj:2"),
    "short vertex": (with_obj("v 0 0\nf 1 1 1\n"), ("scene_invalid",), "a.obj:1"),
    "word as vertex": (with_obj("v a b c\nf 1 1 1\n"), ("scene_invalid",), "a.obj:1"),
    "index zero": (with_obj(TRIANGLE + "f 0 1 2\n"), ("scene_invalid",), "a.obj:4"),
    "index beyond": (with_obj(TRIANGLE + "f 1 2 9\n"), ("scene_invalid",), "a.obj:4"),
    "index before": (with_obj(TRIANGLE + "f 1 2 -9\n"), ("scene_invalid",), "a.obj:4"),
    "overflowing index": (with_obj(TRIANGLE + "f 1 2 99999999999999999999\n"), ("scene_invalid",), "a.obj:4"),
    "two corners": (with_obj(TRIANGLE + "f 1 2\n"), ("scene_invalid",), "a.obj:4"),
    "bad mtl": (zip_of({"box.obj": BOX_OBJ, "box.mtl": "newmtl grey\nKd red\n"}), ("scene_invalid",), "box.mtl:2"),
    "NaN in mtl": (zip_of({"box.obj": BOX_OBJ, "box.mtl": "newmtl grey\nKd nan 0 0\n"}), ("scene_invalid",), "box.mtl:2"),
    "mtl before newmtl": (zip_of({"box.obj": BOX_OBJ, "box.mtl": "Kd 1 1 1\n"}), ("scene_invalid",), "box.mtl:1"),
    "sidecar not json": (with_sidecar("{"), ("scene_invalid",), "raykiln.json"),
    "sidecar unknown field": (with_sidecar({"fog": 1}), ("scene_invalid",), "raykiln.json"),
    "sidecar wrong camera": (with_sidecar({"camera": {"eye": [0, 0, 0]}}), ("scene_invalid",), "camera"),
    "sidecar deep": (with_sidecar("[" * 100000), ("scene_invalid",), "raykiln.json"),
    "sidecar huge number": (with_sidecar('{"background": [1e999, 0, 0]}'), ("scene_invalid",), "raykiln.json"),
}


def glb_with(**extra) -> bytes:
    return triangle_glb(**extra)


GLBS = {
    "empty": (b"", SCENE_CODES, ""),
    "header only": (struct.pack("<III", 0x46546C67, 2, 12), SCENE_CODES, ""),
    "version 1": (struct.pack("<III", 0x46546C67, 1, 20) + bytes(8), ("scene_unsupported",), ""),
    "cut": (triangle_glb()[:-20], SCENE_CODES, ""),
    "length lies": (triangle_glb()[:8] + b"\xff\xff\xff\x7f" + triangle_glb()[12:], SCENE_CODES, ""),
    "not json": (glb_of({}, b"")[:20] + b"{" * 8, SCENE_CODES, ""),
    "NaN vertex": (triangle_glb(((0, 0, 0), (float("nan"), 0, 0), (0, 1, 0))), ("scene_invalid",), ""),
    "accessor beyond": (glb_with(accessors=[{"bufferView": 0, "componentType": 5126, "count": 1000000, "type": "VEC3"}]), ("scene_invalid",), "/accessors/0"),
    "view beyond": (glb_with(bufferViews=[{"buffer": 0, "byteLength": 4000000000}]), ("scene_invalid",), "/bufferViews/0"),
    "negative offset": (glb_with(bufferViews=[{"buffer": 0, "byteOffset": -4, "byteLength": 36}]), ("scene_invalid",), "/bufferViews/0"),
    "node in itself": (glb_with(nodes=[{"mesh": 0, "children": [0]}]), ("scene_invalid",), "/nodes"),
    "required extension": (glb_with(extensionsRequired=["KHR_draco_mesh_compression"]), ("scene_unsupported",), "KHR_draco_mesh_compression"),
    "no mesh": (glb_with(nodes=[{}]), ("scene_empty",), ""),
    "file outside": (glb_with(buffers=[{"byteLength": 36, "uri": "../../../../etc/passwd"}]), SCENE_CODES + ("unsafe_name",), ""),
    "singular transform": (glb_with(nodes=[{"mesh": 0, "scale": [0, 0, 0]}]), SCENE_CODES, ""),
    "infinite transform": (glb_with(nodes=[{"mesh": 0, "scale": [1e300, 1e300, 1e300]}]), SCENE_CODES, ""),
}


@pytest.fixture(scope="module")
def empty(tmp_path_factory):
    """A daemon whose store must stay as empty as it began."""
    from support.api import Api
    from support.daemon import Daemon

    api = Api(Daemon(tmp_path_factory.mktemp("hostile") / "store").start())
    api.before = api.daemon.files()
    yield api
    assert api.daemon.stop() == 0


def refused(api, data, kind, codes, mention):
    data = data() if callable(data) else data
    answer = api.upload(data, kind, expect=(400, 413, 422))
    body = problem(answer, answer.status_code, answer.json()["code"])
    assert body["code"] in codes, body
    assert mention in body.get("where", "") + " " + body["detail"], body
    assert api.daemon.alive()
    api.daemon.wait_for_files(api.before)
    assert api.json("/v1/scenes")["scenes"] == []


@pytest.mark.parametrize("name", ZIPS)
def test_zip(empty, name):
    refused(empty, ZIPS[name][0], ZIP, *ZIPS[name][1:])


@pytest.mark.parametrize("name", GLBS)
def test_glb(empty, name):
    refused(empty, GLBS[name][0], GLB, *GLBS[name][1:])


@pytest.mark.parametrize("length", [22, 30, 60, 100, 150, 200, 300])
def test_every_cut_of_a_zip(empty, length):
    refused(empty, WHOLE[:length], ZIP, ARCHIVE_CODES + SCENE_CODES, "")


def multipart(*parts: bytes, boundary=b"xyz", end=b"--xyz--\r\n") -> bytes:
    return b"".join(b"--" + boundary + b"\r\n" + part + b"\r\n" for part in parts) + end


def part(name: str, content: bytes = b"v 0 0 0\n") -> bytes:
    return f'Content-Disposition: form-data; name="f"; filename="{name}"'.encode() + b"\r\n\r\n" + content


MULTIPARTS = {
    "no part": (multipart(), ("invalid_multipart", "scene_unsupported", "scene_empty")),
    "cut": (multipart(part("a.obj"), end=b""), ("invalid_multipart",)),
    "no filename": (multipart(b'Content-Disposition: form-data; name="f"\r\n\r\nx'), ("invalid_multipart", "unsafe_name")),
    "no disposition": (multipart(b"\r\nx"), ("invalid_multipart",)),
    "traversal": (multipart(part("../a.obj")), ("unsafe_name",)),
    "absolute": (multipart(part("/a.obj")), ("unsafe_name",)),
    "repeated": (multipart(part("a.obj"), part("a.obj")), ("unsafe_name",)),
    "too many": (multipart(*[part(f"{i}.mtl") for i in range(300)]), ("invalid_multipart", "payload_too_large", "archive_too_large")),
    "endless part head": (multipart(b"X: " + b"a" * 200000 + b"\r\n\r\nx"), ("invalid_multipart",)),
    "garbage": (b"hello", ("invalid_multipart",)),
}


@pytest.mark.parametrize("name", MULTIPARTS)
def test_multipart(empty, name):
    data, codes = MULTIPARTS[name]
    refused(empty, data, "multipart/form-data; boundary=xyz", codes, "")


@pytest.mark.parametrize("kind", ["multipart/form-data", "multipart/form-data; boundary=",
                                  "multipart/form-data; boundary=" + "a" * 200])
def test_multipart_without_a_boundary(empty, kind):
    answer = empty.upload(b"--x--\r\n", kind, expect=(400, 415))
    problem(answer, answer.status_code, answer.json()["code"])


def test_the_daemon_still_works_afterwards(empty):
    scene = empty.scene(scenes.box_zip("after the attacks"))
    assert empty.wait(empty.job(scene))["state"] == "completed"
    empty.delete(scene)
    assert set(empty.daemon.files()) >= set(empty.before)
