"""Layers of a picture, and error against time."""

import numpy as np
import pytest

from support.api import problem
from support.daemon import SLOW
from support.image_files import read_png


@pytest.fixture(scope="module")
def done(shared, samples):
    request = {"width": 40, "height": 30, "tile": 16, "stop": {"samples": 64}}
    return shared.wait(shared.submit(samples["box"], **request).json()["id"])


@pytest.mark.parametrize("layer", ["error", "samples", "seconds"])
def test_a_map_is_a_png_with_its_range(api, done, layer):
    answer = api.image(done["id"], layer=layer)
    picture = read_png(answer.content)
    assert (picture.width, picture.height) == (40, 30)
    low, high = float(answer.headers["Raykiln-Low"]), float(answer.headers["Raykiln-High"])
    assert 0 <= low < high
    assert answer.headers["Raykiln-Scale"] == ("linear" if layer == "samples" else "log")
    beauty = api.image(done["id"])
    assert "Raykiln-Low" not in beauty.headers and beauty.headers["ETag"] != answer.headers["ETag"]
    again = api.image(done["id"], layer=layer, expect=(304,), headers={"If-None-Match": answer.headers["ETag"]})
    assert again.content == b""
    if layer == "samples":
        assert high == 100 and len(np.unique(picture.pixels.reshape(-1, 3), axis=0)) == 1


def test_an_exr_holds_error_and_samples(api, done):
    head = api.image(done["id"], "exr").content[:1000]
    for channel in (b"error.R\0", b"error.G\0", b"error.B\0", b"samples\0"):
        assert channel in head, channel
    assert b"seconds\0" in api.image(done["id"], "exr", layer="seconds").content[:1000]


def test_there_are_no_other_layers(api, done):
    problem(api.image(done["id"], layer="normals", expect=(400,)), 400, "invalid_parameter")


def test_the_curve_of_a_job(api, samples, done):
    short = api.json(f"/v1/jobs/{done['id']}/accuracy")
    assert short["job"] == done["id"] and short["points"][-1]["samples"] == 64
    assert short["points"][-1]["error"] == done["accuracy"]["error"]
    assert short["target"] is None and short["seconds_to_target"] is None

    for time in (1.5, 6, 24):  # until a busy machine has seen the error fall
        request = {"width": 32, "height": 24, "stop": {"seconds": time * SLOW, "error": 0.0001}}
        job = api.wait(api.submit(samples["box"], **request).json()["id"])
        curve = api.json(f"/v1/jobs/{job['id']}/accuracy")
        if len(curve["points"]) >= 4 and curve["forecasts"]:
            break
    seconds = [point["render_seconds"] for point in curve["points"]]
    assert len(seconds) >= 4 and seconds == sorted(seconds)
    assert curve["points"][0]["error"]["value"] > curve["points"][-1]["error"]["value"]
    half = curve["seconds_to_halve_error"]
    assert 0 < half["low"] <= half["value"] <= half["high"]
    assert curve["seconds_to_target"]["low"] > half["low"]
    assert curve["forecasts"] and all(one["seconds"]["low"] < one["seconds"]["high"] for one in curve["forecasts"])
