"""Models that no one here made: every .obj, .gltf and .glb of Debian's assimp-testmodels
renders, or is refused with a reason."""

import json
from pathlib import Path
from urllib.parse import unquote

import numpy as np
import pytest

from support.api import GLB, problem
from support.image_files import read_exr

MODELS = Path("/usr/share/assimp/models")
MUST_RENDER = {"OBJ/spider.obj", "OBJ/box.obj", "OBJ/WusonOBJ.obj", "OBJ/concave_polygon.obj",
               "glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb",
               "glTF2/BoxTextured-glTF/BoxTextured.gltf", "glTF2/cameras/Cameras.gltf"}
MUST_REFUSE = {"invalid/empty.obj": "scene_empty", "glTF2/MissingBin/BoxTextured.gltf": None,
               "glTF2/draco/2CylinderEngine.gltf": "scene_unsupported"}


def models():
    found = sorted(str(path.relative_to(MODELS)) for path in MODELS.rglob("*")
                   if path.suffix.lower() in (".obj", ".gltf", ".glb"))
    return found or ["(the package assimp-testmodels is not installed)"]


def companions(path: Path) -> dict:
    """The model and the files it names, by the names it uses."""
    files = {path.name: path.read_bytes()}
    if path.suffix.lower() == ".obj":
        text = files[path.name].decode("utf-8", "replace")
        names = [line.split(None, 1)[1].strip() for line in text.splitlines()
                 if line.startswith("mtllib ")]
        names += [name for library in names for name in mtl_pictures(path.parent / library)]
    else:
        names = uris(files[path.name])
    for name in names:
        beside = path.parent / name
        if beside.is_file() and ".." not in Path(name).parts:
            files[name] = beside.read_bytes()
    return files


def mtl_pictures(library: Path) -> list:
    text = library.read_text("utf-8", "replace") if library.is_file() else ""
    return [line.split(None, 1)[1].strip().replace("\\", "/").removeprefix("./")
            for line in text.splitlines() if line.strip().startswith(("map_Kd ", "map_Ke ", "map_d "))]


def uris(document: bytes) -> list:
    try:
        root = json.loads(document)
        lists = [root.get("buffers", []), root.get("images", [])]
    except (ValueError, AttributeError):
        return []
    entries = [entry for each in lists
               for entry in (each.values() if isinstance(each, dict) else each)]
    found = [entry.get("uri") for entry in entries if isinstance(entry, dict)]
    return [unquote(uri) for uri in found if isinstance(uri, str) and not uri.startswith("data:")]


@pytest.mark.parametrize("name", models())
def test_renders_or_says_why_not(api, name):
    path = MODELS / name
    if path.suffix.lower() == ".glb":
        answer = api.upload(path.read_bytes(), GLB, expect=(200, 201, 422))
    else:
        files = companions(path)
        answer = api.upload_files(files, expect=(200, 201, 400, 422))
    if answer.status_code >= 400:
        assert name not in MUST_RENDER, answer.text
        body = problem(answer, answer.status_code, answer.json()["code"])
        assert body["code"].startswith(("scene_", "unsafe_name")), body
        assert MUST_REFUSE.get(name) in (None, body["code"]), body
        assert len(body["detail"]) > 5
        return
    assert name not in MUST_REFUSE, answer.text
    final = api.wait(api.job(answer.json()["id"], width=24, height=16, stop={"samples": 2}))
    assert final["state"] == "completed", final["error"]
    assert final["statistics"]["non_finite_samples"] == 0
    picture = read_exr(api.image(final["id"], "exr").content)
    assert np.isfinite(picture.pixels).all()
    if name in MUST_RENDER:
        assert picture.pixels.std() > 0, "the default view must show the model"


def test_gltf_1_is_named_as_such(api):
    path = MODELS / "glTF" / "BoxTextured-glTF-Embedded" / "BoxTextured.gltf"
    answer = api.upload_files(companions(path), expect=(422,))
    assert "1" in problem(answer, 422, "scene_unsupported")["detail"]


def test_spider_has_its_materials(api):
    scene = api.upload_files(companions(MODELS / "OBJ" / "spider.obj")).json()
    dropped = sum(w["count"] for w in scene["warnings"] if w["code"] == "zero_area_triangles")
    assert scene["triangles"] + dropped == 1368 and scene["materials"] >= 4
    assert not any("texture" in warning["code"] for warning in scene["warnings"]), scene["warnings"]
    less = companions(MODELS / "OBJ" / "spider.obj")
    del less["SpiderTex.jpg"]
    body = problem(api.upload_files(less, expect=(422,)), 422, "scene_invalid")
    assert "SpiderTex.jpg" in body["detail"] and body["where"].startswith("spider.mtl:"), body
