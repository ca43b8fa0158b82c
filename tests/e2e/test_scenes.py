"""Uploads: every kind, known scenes, digests, lists, deletion."""

import hashlib

from support import scenes
from support.api import GLB, ZIP, problem
from support.patience import eventually


def multipart_id(files: dict) -> str:
    """The scene id of a multipart upload, from the contract's words alone."""
    digest = hashlib.sha256()
    for name in sorted(files, key=str.encode):
        content = files[name].encode() if isinstance(files[name], str) else files[name]
        line = f"{len(content)}\0{hashlib.sha256(content).hexdigest()}\n"
        digest.update(name.encode() + b"\0" + line.encode())
    return digest.hexdigest()


def test_zip_is_created_then_known(api):
    data = scenes.box_zip("created then known")
    first = api.upload(data, expect=(201,))
    scene = first.json()
    assert scene["id"] == hashlib.sha256(data).hexdigest()
    assert first.headers["Location"] == f"/v1/scenes/{scene['id']}"
    assert (scene["triangles"], scene["kind"], scene["bytes"]) == (12, "zip", len(data))
    assert scene["bounds"] == {"min": [-1, -1, -1], "max": [1, 1, 1]}
    assert scene["lights"]["point"] == 1
    again = api.upload(data, expect=(200,))
    assert again.json()["id"] == scene["id"]
    assert again.headers["Location"] == first.headers["Location"]


def test_glb(api):
    data = scenes.triangle_glb()
    scene = api.upload(data, GLB).json()
    assert (scene["id"], scene["kind"]) == (hashlib.sha256(data).hexdigest(), "glb")
    assert scene["triangles"] == 1


def test_multipart_id_is_that_of_the_sorted_list(api):
    files = scenes.box_files("multipart")
    scene = api.upload_files(files, expect=(201,)).json()
    assert (scene["id"], scene["kind"]) == (multipart_id(files), "files")
    backwards = dict(reversed(files.items()))
    assert api.upload_files(backwards, expect=(200,)).json()["id"] == scene["id"]


def test_a_missing_texture_is_named_or_left_out_when_asked(launch):
    api = launch()
    files = scenes.box_files("texture")
    files["box.mtl"] = files["box.mtl"].replace("newmtl ", "newmtl unused\nmap_Kd gone.png\nnewmtl ", 1)
    data = scenes.zip_of(files)
    assert "gone.png" in api.upload(data, expect=(422,)).json()["detail"]
    problem(api.upload(data, params={"allow_missing": "yes"}, expect=(400,)), 400, "invalid_parameter")
    scene = api.upload(data, params={"allow_missing": "true"}, expect=(201,)).json()
    assert [w["count"] for w in scene["warnings"] if w["code"] == "ignored_texture"] == [1]
    # What was taken once stays what it is: for jobs, and for uploads without the parameter.
    api.upload(data, expect=(200,))
    assert api.wait(api.job(scene["id"]))["state"] == "completed"


def test_put_of_the_right_bytes(api):
    data = scenes.box_zip("put")
    digest = hashlib.sha256(data).hexdigest()
    assert api.put(data, expect=(201,)).json()["id"] == digest
    assert api.put(data, expect=(200,)).json()["id"] == digest


def test_put_of_other_bytes_keeps_nothing(launch):
    api = launch()
    before = api.daemon.files()
    problem(api.put(scenes.box_zip(), digest="0" * 64, expect=(422,)), 422, "digest_mismatch")
    problem(api.get(f"/v1/scenes/{'0' * 64}"), 404, "scene_not_found")
    assert api.json("/v1/scenes")["scenes"] == []
    api.daemon.wait_for_files(before)


def test_a_wrong_id_is_an_error_of_the_parameter(api):
    answer = api.request("PUT", "/v1/scenes/abc", data=b"", headers={"Content-Type": ZIP})
    problem(answer, 400, "invalid_parameter")


def test_media_types(api):
    answer = api.upload(b"hello", "text/plain", expect=(415,))
    problem(answer, 415, "unsupported_media_type")


def test_names(api):
    data = scenes.box_zip("a name for people")
    assert api.upload(data, params={"name": "Kästchen"}).json()["name"] == "Kästchen"


def test_list_is_paged_newest_first(launch):
    api = launch()
    ids = [api.scene(scenes.box_zip(f"page {i}")) for i in range(5)]
    seen, cursor, pages = [], None, 0
    while True:
        query = {"limit": 2, **({"cursor": cursor} if cursor else {})}
        page = api.json("/v1/scenes", params=query)
        seen += [scene["id"] for scene in page["scenes"]]
        pages += 1
        cursor = page["next_cursor"]
        if cursor is None:
            break
    assert (seen, pages) == (ids[::-1], 3)
    for query in ({"limit": 0}, {"limit": 201}, {"limit": "x"}, {"cursor": "!!"}):
        problem(api.get("/v1/scenes", params=query), 400, "invalid_parameter")
    problem(api.get("/v1/scenes", params={"colour": "red"}), 400, "unknown_parameter")


def test_delete(launch):
    api = launch()
    before = api.daemon.files()
    scene = api.scene(scenes.box_zip())
    assert api.daemon.files() != before
    api.delete(scene)
    problem(api.get(f"/v1/scenes/{scene}"), 404, "scene_not_found")
    problem(api.delete(scene, expect=(404,)), 404, "scene_not_found")
    api.daemon.wait_for_files(before)
    assert api.upload(scenes.box_zip(), expect=(201,)).json()["id"] == scene


def test_delete_is_refused_while_a_job_needs_it(launch):
    api = launch()
    scene = api.scene(scenes.grid_zip(30))
    job = api.job(scene, width=512, height=512, stop={"samples": 4096})
    problem(api.delete(scene, expect=(409,)), 409, "scene_in_use")
    api.cancel(job)
    assert api.wait(job)["state"] == "cancelled"
    api.delete(scene)


def test_the_picture_outlives_its_scene(launch):
    api = launch()
    scene = api.scene(scenes.box_zip())
    job = api.job(scene)
    assert api.wait(job)["state"] == "completed"
    picture = api.image(job).content
    api.delete(scene)
    assert api.image(job).content == picture


def test_the_tree_is_built_once_for_the_same_geometry(launch):
    api = launch()
    data = scenes.grid_obj(40)
    first = api.scene(scenes.zip_of({"grid.obj": data}))
    sidecar = '{"background": [1, 1, 1]}'
    second = api.scene(scenes.zip_of({"grid.obj": data, "raykiln.json": sidecar}))
    assert first != second
    assert api.json(f"/v1/scenes/{first}")["tree"] is None
    assert api.wait(api.job(first))["state"] == "completed"
    assert api.wait(api.job(second, camera={"eye": [0, 3, 3], "look_at": [0, 0, 0]}))["state"] == "completed"
    tree = api.json(f"/v1/scenes/{first}")["tree"]
    assert tree["nodes"] > 1 and tree["references"] >= 3200 and tree["bytes"] > 0
    assert builds(api) == 1


def test_prepare_builds_without_a_job(launch):
    api = launch()
    scene = api.scene(scenes.grid_zip(20))
    answer = api.request("POST", f"/v1/scenes/{scene}/prepare")
    assert answer.status_code == 202 and answer.headers["Location"] == f"/v1/scenes/{scene}"
    eventually(lambda: api.json(f"/v1/scenes/{scene}")["cache"] == "ready")
    assert api.wait(api.job(scene))["state"] == "completed"
    assert builds(api) == 1


def builds(api) -> int:
    """Completed tree builds, from /metrics."""
    for line in api.get("/metrics").text.splitlines():
        name, _, value = line.rpartition(" ")
        if name.startswith("raykiln_tree_builds_total"):
            return int(float(value))
    raise AssertionError("no raykiln_tree_builds_total in /metrics")
