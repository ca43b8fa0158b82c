"""Pictures: partial and final, PNG and EXR, exposure, conditional requests."""

import numpy as np
import pytest

from support import scenes
from support.api import problem
from support.daemon import fewer
from support.image_files import read_exr, read_png


@pytest.fixture(scope="module")
def done(shared, samples):
    """A finished job of 48 x 40 pixels."""
    job = shared.job(samples["box"], width=48, height=40, stop={"samples": 16}, seed=3)
    assert shared.wait(job)["state"] == "completed"
    return job


def test_png_and_exr_are_whole_and_agree(api, done):
    png_answer, exr_answer = api.image(done, "png"), api.image(done, "exr")
    assert png_answer.headers["Content-Type"] == "image/png"
    assert exr_answer.headers["Content-Type"] == "image/x-exr"
    png, exr = read_png(png_answer.content), read_exr(exr_answer.content)
    assert (png.width, png.height) == (exr.width, exr.height) == (48, 40)
    assert exr.channels == ["R", "G", "B"]
    assert np.isfinite(exr.pixels).all() and exr.pixels.min() >= 0
    assert exr.pixels.std() > 0.01, "there is something to see"
    expected = srgb_bytes(exr.pixels)
    assert np.abs(png.pixels[:, :, :3].astype(int) - expected).max() <= 1


def srgb_bytes(linear):
    """The sRGB transfer curve (IEC 61966-2-1) and rounding to 8 bits."""
    clipped = np.clip(linear, 0, 1)
    curve = np.where(clipped <= 0.0031308, 12.92 * clipped,
                     1.055 * np.power(clipped, 1 / 2.4) - 0.055)
    return np.floor(255 * curve + 0.5).astype(int)


def test_exposure_is_in_stops_and_leaves_exr_alone(api, done):
    exr = read_exr(api.image(done, "exr").content)
    brighter = read_png(api.image(done, "png", exposure=1.5).content)
    expected = srgb_bytes(exr.pixels * 2**1.5)
    assert np.abs(brighter.pixels[:, :, :3].astype(int) - expected).max() <= 1
    assert api.image(done, "exr", exposure=5).content == api.image(done, "exr").content
    for bad in ("33", "nan", "inf", "x", ""):
        problem(api.image(done, exposure=bad, expect=(400,)), 400, "invalid_parameter")


def test_exr_says_how_it_was_made(api, done, samples):
    metadata = read_exr(api.image(done, "exr").content).metadata
    text = " ".join(f"{name}={value}" for name, value in metadata.items()
                    if isinstance(value, (str, int, float)))
    assert samples["box"] in text, text
    for word in ("seed", "samples", "seconds", "version", "light"):
        assert word in text.lower(), f"{word} is missing in {text}"


def test_etag_and_not_modified(api, done):
    first = api.image(done)
    tag = first.headers["ETag"]
    assert int(first.headers["Raykiln-Revision"]) >= 1
    assert first.headers["Cache-Control"] == "no-cache"
    for condition in (tag, f'"x", {tag}', "*"):
        same = api.image(done, headers={"If-None-Match": condition}, expect=(304,))
        assert same.content == b"" and same.headers["ETag"] == tag
    assert api.image(done, headers={"If-None-Match": '"other"'}).content == first.content
    tags = {api.image(done, **q).headers["ETag"] for q in ({"exposure": 1}, {"kind": "exr"})}
    assert len(tags | {tag}) == 3, "each variant has a tag of its own"


def test_head_gives_the_size_without_the_picture(api, done):
    head = api.request("HEAD", f"/v1/jobs/{done}/image")
    assert head.status_code == 200 and head.content == b""
    assert int(head.headers["Content-Length"]) == len(api.image(done).content)


def test_parameters_are_checked(api, done):
    for query in ({"kind": "bmp"}, {"layer": "depth"}, {"rev": "-1"}, {"rev": "x"}):
        problem(api.image(done, expect=(400,), **query), 400, "invalid_parameter")
    problem(api.image(done, expect=(400,), size=3), 400, "unknown_parameter")


def test_partial_then_final(launch):
    api = launch()
    job = api.job(api.scene(scenes.grid_zip(80)), width=320, height=240, stop={"samples": fewer(48)})
    seen = api.wait_until(job, lambda snapshot: snapshot["image"])
    assert seen["progress"]["fraction"] < 1, "the first picture must come before the last sample"
    partial = api.get(seen["image"]["png"])
    assert partial.status_code == 200
    picture = read_png(partial.content)
    assert (picture.width, picture.height) == (320, 240)
    assert int(partial.headers["Raykiln-Revision"]) >= seen["image"]["revision"]
    final = api.wait(job)
    whole = api.image(job, rev=seen["image"]["revision"])
    assert whole.headers["ETag"] != partial.headers["ETag"]
    assert int(whole.headers["Raykiln-Revision"]) == final["image"]["revision"]
    assert whole.content != partial.content


def test_no_picture_yet(launch):
    api = launch(workers=1)
    scene = api.scene(scenes.grid_zip(400))
    job = api.job(scene)
    answer = api.image(job, expect=(404,))
    problem(answer, 404, "image_not_ready")
    assert int(answer.headers["Retry-After"]) >= 1
    api.wait(job)
    api.image(job)
