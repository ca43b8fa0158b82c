"""What a job simulates: auto is all, bit for bit; what is left out by name is marked everywhere."""

import hashlib
import json
import re

import numpy as np
import pytest

from support import scenes
from support.api import problem
from support.image_files import read_exr
from test_cli import raykiln

SIZE = {"width": 40, "height": 30, "stop": {"samples": 8}, "max_depth": 12}


def glass_zip() -> bytes:
    """The box with its red side of glass, over a grey floor."""
    files = scenes.box_files("glass")
    sidecar = json.loads(files["raykiln.json"])
    sidecar["materials"] = {"red": {"diffuse": [0, 0, 0], "specular": [1, 1, 1], "transparent": 1,
                                    "specular_exp": 1e9, "index_of_refraction": 1.5}}
    return scenes.zip_of({**files, "raykiln.json": json.dumps(sidecar)})


@pytest.fixture(scope="module")
def glass(shared):
    return shared.scene(glass_zip())


def rendered(api, scene, effects):
    """The finished job, and the pixels of its picture."""
    job = api.wait(api.job(scene, effects=effects, **SIZE))
    assert job["state"] == "completed", job["error"]
    return job, read_exr(api.image(job["id"], "exr").content)


def digest(picture) -> str:
    return hashlib.sha256(np.ascontiguousarray(picture.pixels).tobytes()).hexdigest()


def verdicts(report) -> dict:
    return {line["effect"]: line for line in report["list"]}


def test_auto_and_all_give_the_same_picture(api, glass, samples):
    for scene in (glass, samples["box"], samples["grid"]):
        (auto, lean), (everything, general) = (rendered(api, scene, choice) for choice in ("auto", "all"))
        assert digest(lean) == digest(general)
        assert api.image(auto["id"]).content == api.image(everything["id"]).content
        assert auto["effects"]["label"] == "auto" and everything["effects"]["label"] == "all"
        assert all(line["simulated"] for line in everything["effects"]["list"])
        assert not all(line["simulated"] for line in auto["effects"]["list"])
        for job in (auto, everything):
            assert not job["effects"]["approximation"]
            assert "deliberate_approximation" not in [w["code"] for w in job["warnings"]]


def test_glass_without_refraction_is_another_picture_and_says_so(api, glass):
    full, picture = rendered(api, glass, "auto")
    assert verdicts(full["effects"])["refraction"]["simulated"]
    draft, lacking = rendered(api, glass, {"without": ["refraction"]})
    assert draft["request"]["effects"] == {"without": ["refraction"]}
    assert digest(picture) != digest(lacking)
    line = verdicts(draft["effects"])["refraction"]
    assert (line["called_for"], line["simulated"], line["grade"]) == (True, False, "bounded")
    assert "material `red`" in line["evidence"] and line["left_out"]
    assert draft["effects"]["approximation"]
    warning = next(w for w in draft["warnings"] if w["code"] == "deliberate_approximation")
    assert "refraction (bounded)" in warning["message"] and warning["where"] == "/effects"

    label = "without=refraction (refraction bounded)"
    assert lacking.metadata["raykiln:effects"] == label == draft["effects"]["label"]
    assert "refraction" not in lacking.metadata["raykiln:simulated"].split(",")
    assert picture.metadata["raykiln:effects"] == "auto"
    assert "refraction" in picture.metadata["raykiln:simulated"].split(",")
    half = read_exr(api.image(draft["id"], "exr", type="half").content)
    assert half.metadata["raykiln:effects"] == label
    for layer in ("beauty", "error"):
        assert label.encode() in api.image(draft["id"], layer=layer).content
        assert b"Deliberate" not in api.image(full["id"], layer=layer).content

    place = {"x": 20, "y": 15, "sample": 3}
    again = [api.json(f"/v1/jobs/{job['id']}/samples", params=place) for job in (full, draft)]
    assert [sample["effects"] for sample in again] == ["auto", label]


def test_a_replayed_sample_lacks_what_its_job_lacks(api, glass):
    job = api.job(glass, effects={"without": ["refraction"]}, **{**SIZE, "stop": {"samples": 1}})
    assert api.wait(job)["state"] == "completed"
    picture = read_exr(api.image(job, "exr").content).pixels
    for y in range(0, 30, 5):
        for x in range(0, 40, 8):
            sample = api.json(f"/v1/jobs/{job}/samples", params={"x": x, "y": y, "sample": 0})
            assert np.array_equal(np.float32(sample["radiance"]), np.float32(picture[y, x])), (x, y)


def test_leaving_out_what_is_not_called_for_is_no_approximation(api, samples):
    full, picture = rendered(api, samples["box"], "auto")
    same, also = rendered(api, samples["box"], {"without": ["caustics", "refraction"]})
    assert digest(picture) == digest(also) and not same["effects"]["approximation"]
    assert same["effects"]["label"] == "without=refraction,caustics"


def test_a_scene_reports_what_it_calls_for(api, glass, samples):
    of_glass, of_box = (api.json(f"/v1/scenes/{scene}")["effects"] for scene in (glass, samples["box"]))
    assert of_glass["label"] == of_box["label"] == "auto"
    assert [line["effect"] for line in of_glass["list"]] == [line["effect"] for line in of_box["list"]]
    assert verdicts(of_glass)["refraction"]["called_for"]
    line = verdicts(of_box)["refraction"]
    assert not line["called_for"] and line["grade"] == "identical" and line["left_out"]
    job = api.wait(api.job(samples["box"]))
    assert job["effects"] == of_box


def box_with_normals(tilt) -> bytes:
    """The box with a normal for each side: that of its plane, tilted."""
    sides = [(0, 0, -1), (0, 0, 1), (0, -1, 0), (0, 1, 0), (-1, 0, 0), (1, 0, 0)]
    normals = "".join(f"vn {x + tilt} {y + tilt} {z + tilt}\n" for x, y, z in sides)
    lines, side = [], 0
    for line in scenes.BOX_OBJ.splitlines():
        if line.startswith("f "):
            side += 1
            line = "f " + " ".join(f"{corner}//{side}" for corner in line.split()[1:])
        lines.append(line)
    return scenes.zip_of({**scenes.box_files(), "box.obj": normals + "\n".join(lines) + "\n"})


def test_normals_that_change_nothing_take_no_memory(launch):
    kept = {}
    for name, data in (("none", scenes.box_zip()), ("flat", box_with_normals(0)), ("bent", box_with_normals(0.2))):
        api = launch(store=name)
        job = api.wait(api.job(api.scene(data)))
        assert verdicts(job["effects"])["shading_normals"]["called_for"] == (name == "bent")
        kept[name] = float(re.search(r"^raykiln_scene_cache_bytes (\S+)$", api.get("/metrics").text, re.M)[1])
    # 12 bytes a normal, three indices a triangle.
    assert kept["none"] == kept["flat"] == kept["bent"] - 6 * 12 - 12 * 12, kept


@pytest.mark.parametrize("effects, pointer", [
    ("some", "/effects"), ("without=refraction", "/effects"), (7, "/effects"), (None, "/effects"), ([], "/effects"),
    ({}, "/effects/without"), ({"without": []}, "/effects/without"), ({"without": "refraction"}, "/effects/without"),
    ({"without": ["moire"]}, "/effects/without/0"), ({"without": ["refraction", "refraction"]}, "/effects/without/1"),
    ({"without": ["refraction"], "with": 1}, "/effects/with")])
def test_other_choices_are_refused_with_their_place(api, samples, effects, pointer):
    body = problem(api.submit(samples["box"], expect=(422,), effects=effects), 422, "invalid_request")
    assert [error["pointer"] for error in body["errors"]] == [pointer]
    if pointer == "/effects/without/0":
        known = [line["effect"] for line in api.json(f"/v1/scenes/{samples['box']}")["effects"]["list"]]
        assert all(name in body["errors"][0]["detail"] for name in known)


def test_the_choice_is_part_of_what_an_idempotency_key_is_bound_to(api, samples):
    key = {"Idempotency-Key": "effects"}
    job = api.submit(samples["box"], headers=key).json()["id"]
    assert api.submit(samples["box"], headers=key, effects="auto").json()["id"] == job
    problem(api.submit(samples["box"], headers=key, effects="all", expect=(409,)), 409, "idempotency_key_reused")


def test_plan_and_mark_survive_a_restart(launch):
    api = launch()
    scene = api.scene(glass_zip())
    job = api.job(scene, effects={"without": ["refraction"]}, **SIZE)
    before, described = api.wait(job), api.json(f"/v1/scenes/{scene}")["effects"]
    assert api.daemon.stop() == 0
    api.daemon.start()
    assert api.state(job)["effects"] == before["effects"] and before["effects"]["approximation"]
    assert api.json(f"/v1/scenes/{scene}")["effects"] == described
    assert "refraction bounded" in read_exr(api.image(job, "exr").content).metadata["raykiln:effects"]


def test_the_cli_submits_a_choice_and_passes_the_mark_on(api, tmp_path):
    path = tmp_path / "glass.zip"
    path.write_bytes(glass_zip())
    done = raykiln("submit", path, "--effects", "without=refraction", "--size", "24x16", "--samples", 2, "--wait",
                   "--json", "--server", api.daemon.url)
    assert done.returncode == 0, done.stderr
    job = json.loads(done.stdout)
    assert job["request"]["effects"] == {"without": ["refraction"]} and job["effects"]["approximation"]
    assert "deliberate approximation" in done.stderr
    assert "approximation" in raykiln("jobs", "--server", api.daemon.url).stdout
    sample = raykiln("replay", job["id"], 3, 4, 0, "--server", api.daemon.url)
    assert "without=refraction (refraction bounded)" in sample.stdout
    here = json.loads(raykiln("effects", path, "--effects", "without=refraction", "--json").stdout)
    assert here == job["effects"]


def test_triangles_tested_in_float_show_nearly_the_same_and_say_so(api, tmp_path):
    """By REST and by the command line: the same float picture, its mark everywhere, and light but for roundings."""
    grid = scenes.grid_zip(60)
    path = tmp_path / "grid.zip"
    path.write_bytes(grid)
    choice = {"without": ["watertight_triangles"]}
    scene = api.scene(grid)
    (full, exact), (draft, by_float) = (rendered(api, scene, effects) for effects in ("auto", choice))
    line = verdicts(full["effects"])["watertight_triangles"]
    assert line["called_for"] and line["simulated"] and line["evidence"] == "7200 triangles"
    line = verdicts(draft["effects"])["watertight_triangles"]
    assert (line["called_for"], line["simulated"], line["grade"]) == (True, False, "unbounded")
    label = "without=watertight_triangles (watertight_triangles unbounded)"
    assert draft["effects"]["label"] == label and draft["effects"]["approximation"]
    warning = next(w for w in draft["warnings"] if w["code"] == "deliberate_approximation")
    assert "watertight_triangles (unbounded)" in warning["message"]
    assert by_float.metadata["raykiln:effects"] == label
    assert "watertight_triangles" not in by_float.metadata["raykiln:simulated"].split(",")
    assert abs(by_float.pixels.mean() / exact.pixels.mean() - 1) < 1e-3
    near = np.isclose(by_float.pixels, exact.pixels, rtol=1e-4).all(axis=2)
    assert near.mean() > 0.9, "hits move by roundings; few paths come out otherwise"
    sample = api.json(f"/v1/jobs/{draft['id']}/samples", params={"x": 20, "y": 15, "sample": 3})
    assert sample["effects"] == label

    options = ("--effects", "without=watertight_triangles", "--size", "40x30", "--samples", 8, "--depth", 12)
    here, there = tmp_path / "here.exr", tmp_path / "there.exr"
    done = raykiln("render", path, "-o", here, *options)
    assert done.returncode == 0, done.stderr
    assert "lacks what the scene calls for, on request: watertight_triangles" in done.stderr
    done = raykiln("submit", path, "-o", there, *options, "--server", api.daemon.url)
    assert done.returncode == 0 and f"effects {label}" in done.stderr
    for picture in (read_exr(here.read_bytes()), read_exr(there.read_bytes())):
        assert digest(picture) == digest(by_float) and picture.metadata["raykiln:effects"] == label
