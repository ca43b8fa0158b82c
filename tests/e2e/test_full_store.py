"""A store without room: what cannot be kept is refused by name, the rest goes on, room that is given back is used."""

import os

from support import scenes
from support.api import GLB, problem
from support.patience import eventually


def test_a_picture_that_cannot_be_kept_fails_its_job_and_no_other(launch):
    api = launch(options=["--store-bytes", "200000"])
    scene = api.scene(scenes.box_zip("full"))
    kept = api.job(scene, width=60, height=60, stop={"samples": 1})
    assert api.wait(kept)["state"] == "completed"  # 32 bytes a pixel: 115 kB
    failed = api.wait(api.job(scene, width=200, height=100, stop={"samples": 1}))  # 640 kB
    assert (failed["state"], failed["error"]["code"]) == ("failed", "storage_full")
    assert failed["error"]["status"] == 507
    assert failed["image"] is None
    problem(api.upload(os.urandom(150_000), GLB, expect=(507,)), 507, "storage_full")
    assert api.image(kept, "exr").status_code == 200
    assert api.wait(api.job(scene, width=20, height=20))["state"] == "completed"
    eventually(lambda: not [name for name in api.daemon.files() if name.startswith(("staging", "scratch"))])


def test_bytes_of_a_deleted_scene_are_given_back(launch):
    large, larger = scenes.grid_zip(60), scenes.grid_zip(61)
    api = launch(options=["--store-bytes", str(len(larger) + len(large) // 2)])
    first = api.scene(large)
    problem(api.upload(larger, expect=(507,)), 507, "storage_full")
    api.delete(first)
    assert api.upload(larger).status_code == 201
