"""Lights of uploads: spots, suns and environment maps, from the sidecar to the picture."""

import json
import struct

import numpy as np

from support import scenes
from support.api import problem
from support.image_files import read_exr

FLOOR = "v -9 0 -9\nv 9 0 -9\nv 9 0 9\nv -9 0 9\nusemtl white\nf 4 3 2 1\n"
MTL = "newmtl white\nKd 0.5 0.5 0.5\nillum 1\n"


def floor_with(files=None, **sidecar):
    document = {"camera": {"eye": [0, 5, 0.01], "look_at": [0, 0, 0], "up": [0, 0, -1], "fov_deg": 20},
                **sidecar}
    return scenes.zip_of({"floor.obj": "mtllib floor.mtl\n" + FLOOR, "floor.mtl": MTL,
                          "raykiln.json": json.dumps(document), **(files or {})})


def radiance_hdr(width, height, texel) -> bytes:
    """A Radiance picture of one grey value a pixel: texel(x, y), a power of two or 0."""
    head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode()
    body = bytearray()
    for y in range(height):
        for x in range(width):
            value = texel(x, y)
            exponent = 0 if value == 0 else int(np.log2(value)) + 129
            mantissa = 0 if value == 0 else 128
            body += struct.pack("BBBB", mantissa, mantissa, mantissa, exponent)
    return head + bytes(body)


def mean_of(api, data, samples=16):
    scene = api.upload(data).json()["id"]
    final = api.wait(api.job(scene, width=16, height=16, stop={"samples": samples}))
    assert final["state"] == "completed", final["error"]
    picture = read_exr(api.image(final["id"], "exr").content)
    return picture.pixels[..., [picture.channels.index(c) for c in "RGB"]].mean()


def test_a_sun_lights_a_floor(api):
    data = floor_with(directional_lights=[{"direction": [1, -1, 0], "irradiance": [2, 2, 2]}])
    assert api.upload(data).json()["lights"]["directional"] == 1
    truth = 0.5 / np.pi * 2 * np.sqrt(0.5)
    assert abs(mean_of(api, data) - truth) < 1e-3 * truth


def test_a_spot_lights_its_cone(api):
    spot = {"position": [0, 3, 0], "direction": [0, -1, 0], "intensity": [9, 9, 9],
            "inner_deg": 60, "outer_deg": 70}
    data = floor_with(spot_lights=[spot])
    assert api.upload(data).json()["lights"]["spot"] == 1
    assert abs(mean_of(api, data) - 0.5 / np.pi) < 0.1 * 0.5 / np.pi  # E is 1 below, less aside
    away = floor_with(spot_lights=[{**spot, "direction": [0, 1, 0]}])
    assert mean_of(api, away) == 0


def test_an_environment_lights_a_floor(api):
    sky = radiance_hdr(8, 4, lambda x, y: 1 if y < 2 else 0)  # 1 above the horizon, 0 below
    data = floor_with({"sky.hdr": sky}, environment={"file": "sky.hdr", "scale": 2})
    assert api.upload(data).json()["lights"]["environment"] is True
    assert abs(mean_of(api, data, 64) - 1.0) < 0.03  # 0.5 / pi times 2 pi


def test_an_environment_that_is_not_there_is_named(api):
    answer = api.upload(floor_with(environment={"file": "sky.hdr"}), expect=(422,))
    body = problem(answer, 422, "scene_invalid")
    assert "sky.hdr" in body["detail"], body
    broken = floor_with({"sky.hdr": b"#?RADIANCE\nbroken"}, environment={"file": "sky.hdr"})
    body = problem(api.upload(broken, expect=(422,)), 422, "scene_invalid")
    assert "sky.hdr" in json.dumps(body), body
