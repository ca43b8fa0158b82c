"""One sample of a job rendered again: the same value, the same fault."""

import json
import shlex

import numpy as np
import pytest

from support import scenes
from support.api import problem
from support.image_files import read_exr
from test_cli import raykiln

ASKED = {"width": 24, "height": 16, "seed": 11, "light_model": "seed",
         "light_model_overrides": {"fresnel": "exact"}, "max_depth": 3,
         "camera": {"eye": [2, 3, 4], "look_at": [0, 0.2, 0], "up": [0, 1, 0], "fov_deg": 50}}


def replayed(api, job, x, y, sample=0, **options):
    return api.get(f"/v1/jobs/{job}/samples", params={"x": x, "y": y, "sample": sample}, **options)


@pytest.fixture(scope="module")
def one_sample(shared, samples):
    """A finished job with one sample a pixel: the picture is that sample."""
    job = shared.job(samples["box"], stop={"samples": 1}, **ASKED)
    assert shared.wait(job)["state"] == "completed"
    return job


def test_a_sample_is_what_the_picture_holds(api, one_sample):
    picture = read_exr(api.image(one_sample, "exr").content).pixels
    assert picture.std() > 0
    for x, y in ((0, 0), (23, 15), (12, 8), (9, 9), (14, 6)):
        answer = replayed(api, one_sample, x, y)
        assert answer.status_code == 200, answer.text
        sample = answer.json()
        assert np.array_equal(np.float32(sample["radiance"]), np.float32(picture[y, x]))
        assert (sample["x"], sample["y"], sample["dropped"]) == (x, y, False)
        assert sample["light_model"].startswith("seed with fresnel=exact") and sample["seed"] == 11


def test_the_cli_replays_a_job(api, one_sample):
    done = raykiln("replay", one_sample, 12, 8, 0, "--json", "--server", api.daemon.url)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == replayed(api, one_sample, 12, 8).json()
    text = raykiln("replay", one_sample, 12, 8, 0, "--server", api.daemon.url).stdout
    assert "pixel (12, 8), sample 0: radiance" in text
    gone = raykiln("replay", "j_none", 0, 0, 0, "--server", api.daemon.url)
    assert gone.returncode == 8 and "job_not_found" in gone.stderr
    out = raykiln("replay", one_sample, 24, 0, 0, "--server", api.daemon.url)
    assert out.returncode == 7 and "invalid_parameter" in out.stderr


@pytest.mark.parametrize("query", [
    "", "x=0&y=0", "x=24&y=0&sample=0", "x=0&y=16&sample=0", "x=-1&y=0&sample=0", "x=0.5&y=0&sample=0",
    "x=0&y=0&sample=1048576", "x=0&y=0&sample=18446744073709551616", "x=&y=0&sample=0", "x=0&x=0&y=0&sample=0",
    "x=nan&y=0&sample=0"])
def test_wrong_places_are_named(api, one_sample, query):
    answer = api.get(f"/v1/jobs/{one_sample}/samples?{query}")
    assert problem(answer, 400, "invalid_parameter")["where"] in ("x", "y", "sample")


def test_other_parameters_and_methods_are_refused(api, one_sample):
    problem(api.get(f"/v1/jobs/{one_sample}/samples?x=0&y=0&sample=0&z=1"), 400, "unknown_parameter")
    problem(api.request("POST", f"/v1/jobs/{one_sample}/samples"), 405, "method_not_allowed")
    problem(replayed(api, "j_none", 0, 0), 404, "job_not_found")


def test_a_sample_that_is_not_finite_is_found_again_by_its_command(api):
    """Walls that double what they reflect, as bright as a scene may be: sums leave float."""
    files = scenes.box_files("too bright")
    sidecar = json.loads(files["raykiln.json"])
    sidecar["materials"] = {name: {"diffuse": [1] * 3, "specular": [1] * 3, "emission": [1e30] * 3} for name in ("grey", "red")}
    sidecar["camera"] = {"eye": [0, 0, 0.9], "look_at": [0, 0, 0], "up": [0, 1, 0], "fov_deg": 60}
    files["raykiln.json"] = json.dumps(sidecar)
    job = api.job(api.scene(scenes.zip_of(files)), width=8, height=8, stop={"samples": 4}, max_depth=100)
    statistics = api.wait(job)["statistics"]
    assert statistics["non_finite_samples"] > 0
    assert 0 < len(statistics["bad_samples"]) <= 16
    for bad in statistics["bad_samples"][:3]:
        command = shlex.split(bad["replay"])
        assert command[0] == "raykiln"
        done = raykiln(*command[1:], "--json", "--server", api.daemon.url)
        assert done.returncode == 0, done.stderr
        sample = json.loads(done.stdout)
        assert sample["dropped"] and (sample["x"], sample["y"]) == (bad["x"], bad["y"])
    assert np.isfinite(read_exr(api.image(job, "exr").content).pixels).all()


def test_a_scene_that_is_not_in_memory_is_made_ready_first(launch):
    api = launch()
    scene = api.scene(scenes.grid_zip(150))
    job = api.job(scene, **{**ASKED, "stop": {"samples": 1}})
    api.wait(job)
    before = replayed(api, job, 5, 5).json()
    assert api.daemon.stop() == 0
    api.daemon.start()
    first = replayed(api, job, 5, 5)
    assert problem(first, 503, "scene_not_ready") and int(first.headers["Retry-After"]) >= 1
    done = raykiln("replay", job, 5, 5, 0, "--json", "--server", api.daemon.url)
    assert done.returncode == 0 and json.loads(done.stdout) == before
    api.delete(scene)
    problem(replayed(api, job, 5, 5), 404, "scene_not_found")


def test_a_job_without_a_tree_says_so_at_once(api):
    scene = api.scene(scenes.box_zip("no tree"))
    job = api.job(scene, **ASKED, tree={"max_bytes": 1})
    error = api.wait(job)["error"]
    assert error["code"] == "tree_too_large"
    told = problem(replayed(api, job, 5, 5), 422, "tree_too_large")
    assert (told["detail"], told["where"]) == (error["detail"], "/tree/max_bytes") and "or more" in told["detail"]
    done = raykiln("replay", job, 5, 5, 0, "--server", api.daemon.url)
    assert done.returncode == 4 and "tree_too_large" in done.stderr and "--tree-bytes" in done.stderr
