"""A scan of 871 thousand triangles that somebody else made: uploaded, built, rendered.

Prints its figures (`pytest -s`) and writes them to build/test-logs/size.json. What it asserts
is that they come out at all, within bounds no machine should miss.
"""

import json
import os
import platform
import subprocess
import time
import zipfile

import numpy as np
import pytest

from support import scenes
from support.daemon import ROOT
from support.image_files import read_exr

pytestmark = pytest.mark.size
TRIANGLES = 871414
LOGS = ROOT / "build" / "test-logs"


@pytest.fixture(scope="module")
def dragon(tmp_path_factory):
    """A zip of the finest level with a camera, some 12 MB."""
    printed = subprocess.run(["node", str(ROOT / "tests" / "support" / "fetch_dragon.mjs"), "1"],
                             check=True, capture_output=True, text=True).stdout
    path = tmp_path_factory.mktemp("dragon") / "dragon.zip"
    sidecar = {"camera": {"eye": [0, 60, 260], "look_at": [0, 50, 0], "up": [0, 1, 0],
                          "fov_deg": 40},
               "background": [0.5, 0.6, 0.8]}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        archive.write(printed.split()[-1], "dragon.obj")
        archive.writestr("raykiln.json", json.dumps(sidecar))
    return path


def test_upload_build_and_render(launch, dragon):
    api = launch(workers=os.cpu_count() or 2)
    idle = api.daemon.status_kib()
    start = time.monotonic()
    with open(dragon, "rb") as source:
        scene = api.upload(source).json()
    upload = time.monotonic() - start
    assert scene["triangles"] + zero_area(scene) == TRIANGLES
    job = api.job(scene["id"], width=640, height=480, stop={"samples": 4})
    final = api.wait(job, timeout=600)
    assert final["state"] == "completed", final["error"]
    picture = read_exr(api.image(job, "exr").content)
    assert np.isfinite(picture.pixels).all() and picture.pixels.std() > 0.01
    tree = api.json(f"/v1/scenes/{scene['id']}")["tree"]
    assert tree["references"] >= scene["triangles"] and tree["bytes"] < 1 << 31
    report({
        "upload_bytes": dragon.stat().st_size, "upload_and_import_seconds": upload,
        "triangles": scene["triangles"], "tree": tree, "render": final["statistics"],
        "elapsed_seconds": final["elapsed_seconds"], "idle_kib": idle,
        "peak_kib": api.daemon.status_kib("VmHWM"),
        "machine": {"cpu": platform.processor() or platform.machine(), "cores": os.cpu_count()},
    })


def zero_area(scene) -> int:
    """Triangles the importer dropped; each such warning says how many."""
    return sum(warning.get("count", 1) for warning in scene["warnings"]
               if warning["code"] in ("zero_area_triangles", "collapsed_triangles"))


def test_the_coarse_level_is_the_same_animal(api, tmp_path):
    """Level 4 in the same view as a sanity check of the converter: it fills some of the frame."""
    path = subprocess.run(["node", str(ROOT / "tests" / "support" / "fetch_dragon.mjs"), "4"],
                          check=True, capture_output=True, text=True).stdout.split()[-1]
    sidecar = {"background": [1, 1, 1]}
    with open(path) as source:
        data = scenes.zip_of({"dragon.obj": source.read(), "raykiln.json": json.dumps(sidecar)})
    job = api.job(api.scene(data), width=64, height=48, stop={"samples": 4})
    assert api.wait(job)["state"] == "completed"
    covered = (read_exr(api.image(job, "exr").content).pixels.mean(axis=2) < 0.99).mean()
    assert 0.05 < covered < 0.95


def report(figures: dict):
    LOGS.mkdir(parents=True, exist_ok=True)
    (LOGS / "size.json").write_text(json.dumps(figures, indent=2) + "\n")
    print(json.dumps(figures, indent=2))
