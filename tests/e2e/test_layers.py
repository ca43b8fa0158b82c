"""Layers beside a picture, from the request to the channels of the file and the pictures of the page."""

import subprocess

import numpy as np

from support import scenes
from support.api import problem
from support.daemon import BIN
from support.image_files import read_exr, read_png

LAYERS = ["albedo", "normal", "depth", "object_id", "material_id", "emission", "direct", "indirect"]
CHANNELS = {"Z", "object_id", "material_id"} | {f"N.{c}" for c in "XYZ"} | {
    f"{name}.{c}" for name in ("albedo", "emission", "direct", "indirect") for c in "RGB"}
SMALL = {"width": 24, "height": 16, "stop": {"samples": 8}}


def channels_of(data):
    exr = read_exr(data, every=True)
    return {name: exr.pixels[..., i] for i, name in enumerate(exr.channels)}


def test_layers_are_channels_that_add_up_to_the_picture_which_they_leave_alone(api, samples):
    plain = api.wait(api.job(samples["box"], **SMALL))
    job = api.wait(api.job(samples["box"], layers=LAYERS[::-1], **SMALL))
    assert job["state"] == "completed" and job["request"]["layers"] == LAYERS
    assert api.image(plain["id"]).content == api.image(job["id"]).content
    before, after = (channels_of(api.image(one["id"], "exr").content) for one in (plain, job))
    assert set(after) - set(before) == CHANNELS
    assert all((before[name] == after[name])[~np.isnan(before[name])].all() for name in before)
    for c in "RGB":
        parts = sum(after[f"{name}.{c}"].astype(float) for name in ("emission", "direct", "indirect"))
        np.testing.assert_allclose(parts, after[c], rtol=1e-5, atol=1e-7)
    scene = api.json(f"/v1/scenes/{samples['box']}")
    assert len(scene["object_names"]) == scene["objects"] and len(scene["material_names"]) == scene["materials"]
    for ids, most in (("object_id", scene["objects"]), ("material_id", scene["materials"])):
        assert set(np.unique(after[ids])) <= set(range(most + 1)) and after[ids].max() >= 1
    assert (after["Z"] > 0).all() and np.isfinite(after["Z"][after["material_id"] > 0]).all()


def test_a_layer_is_a_picture(api, samples):
    job = api.wait(api.job(samples["box"], layers=LAYERS, **SMALL))["id"]
    tags = set()
    for layer in LAYERS:
        answer = api.image(job, layer=layer)
        assert read_png(answer.content).pixels.shape[:2] == (16, 24), layer
        assert ("Raykiln-Low" in answer.headers) == (layer == "depth")
        tags.add(answer.headers["ETag"])
    assert len(tags) == len(LAYERS)
    bright = read_png(api.image(job, layer="direct", exposure=3).content).pixels
    assert bright.mean() > read_png(api.image(job, layer="direct").content).pixels.mean()


def test_only_what_was_asked_for_is_there(api, samples):
    job = api.wait(api.job(samples["box"], layers=["albedo"], **SMALL))["id"]
    answer = problem(api.image(job, layer="depth", expect=(400,)), 400, "invalid_parameter")
    assert '"layers": ["depth"]' in answer["detail"]
    for wrong in ("albedo", ["beauty"], ["albedo", "albedo"]):
        answer = api.submit(samples["box"], expect=(422,), layers=wrong, **SMALL)
        assert problem(answer, 422, "invalid_request")["errors"][0]["pointer"].startswith("/layers")
    large = {"width": 4000, "height": 3500, "stop": {"samples": 1}, "layers": LAYERS}
    problem(api.submit(samples["box"], expect=(422,), **large), 422, "film_too_large")


def test_here_and_on_a_server_they_are_the_same(api, samples, tmp_path):
    (tmp_path / "box.zip").write_bytes(scenes.box_zip())
    out = tmp_path / "box.exr"
    done = subprocess.run([BIN / "raykiln", "render", tmp_path / "box.zip", "--size", "24x16", "--samples", "8", "--tile", "5",
                           "--layers", "normal,depth,object_id,indirect", "-o", out], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    here = channels_of(out.read_bytes())
    job = api.wait(api.job(api.scene(scenes.box_zip()), layers=LAYERS, **SMALL))["id"]
    there = channels_of(api.image(job, "exr").content)
    for name in ("N.X", "N.Y", "N.Z", "Z", "object_id", "indirect.G"):
        assert (here[name] == there[name]).all(), name
    assert "albedo.R" not in here
