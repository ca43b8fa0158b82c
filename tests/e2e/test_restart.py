"""What survives a power cut, an orderly stop, and a different number of workers."""

import signal
import time

import numpy as np

from support import scenes
from support.api import Api
from support.daemon import SLOW, Daemon, fewer
from support.image_files import read_exr

JOB = {"width": 320, "height": 240, "stop": {"samples": fewer(64)}, "seed": 11}


def restarted(api) -> Api:
    old = api.daemon
    return Api(Daemon(old.store, old.workers, old.options).start())


def test_sigkill_while_rendering(launch):
    api = launch()
    grid, box = api.scene(scenes.grid_zip(80)), api.scene(scenes.box_zip())
    finished = api.job(box)
    api.wait(finished)
    picture = api.image(finished, "exr").content
    layers = ["albedo", "normal", "object_id", "direct", "indirect"]
    running, queued = api.job(grid, layers=layers, **JOB), api.job(box, seed=2)
    api.wait_until(running, lambda snapshot: snapshot["progress"]["samples_done"] >= 1)
    api.daemon.kill()
    api = restarted(api)
    try:
        assert {scene["id"] for scene in api.json("/v1/scenes")["scenes"]} == {grid, box}
        assert api.state(finished)["state"] == "completed"
        assert api.image(finished, "exr").content == picture
        for job in (running, queued):
            assert api.wait(job)["state"] == "completed"
        again = api.job(grid, layers=layers, **JOB)
        api.wait(again)
        first, second = (read_exr(api.image(job, "exr").content, every=True) for job in (running, again))
        assert {"albedo.R", "N.Z", "object_id", "direct.G", "indirect.B"} <= set(first.channels)
        assert np.array_equal(first.pixels, second.pixels, equal_nan=True)
        assert api.daemon.stop() == 0
    finally:
        api.daemon.kill()


def test_sigkill_during_an_upload_leaves_nothing(launch):
    api = launch()
    before = api.daemon.files()
    data = scenes.grid_zip(200)

    def half():
        yield data[: len(data) // 2]
        api.daemon.kill()
        yield b"x"

    try:
        api.upload(half())
    except Exception:  # The connection breaks; how is the client library's affair.
        pass
    api = restarted(api)
    try:
        assert api.json("/v1/scenes")["scenes"] == []
        api.daemon.wait_for_files(before)
    finally:
        api.daemon.kill()


def test_cancelled_and_revisions_survive(launch):
    api = launch()
    scene = api.scene(scenes.grid_zip(40))
    job = api.job(scene, width=512, height=512, stop={"samples": 1048576})
    api.wait_until(job, lambda snapshot: snapshot["image"])
    api.cancel(job)
    final = api.wait(job)
    assert api.daemon.stop() == 0
    api = restarted(api)
    try:
        again = api.state(job)
        assert (again["state"], again["revision"]) == ("cancelled", final["revision"])
        assert len(api.image(job).content) > 100, "the partial picture is still there"
    finally:
        api.daemon.kill()


def test_sigterm_drains(launch):
    """A job that is nearly done completes; the exit code is 0; new work is refused."""
    api = launch()
    scene = api.scene(scenes.box_zip())
    job = api.job(scene, width=200, height=150, stop={"samples": 64})
    api.wait_until(job, lambda snapshot: snapshot["state"] != "queued")
    assert api.daemon.stop() == 0
    api = restarted(api)
    try:
        assert api.wait(job)["state"] == "completed"
    finally:
        api.daemon.kill()


def test_sigterm_stops_an_endless_job_by_its_deadline(launch):
    api = launch(options=["--drain-seconds", "3"])
    job = api.job(api.scene(scenes.grid_zip(40)), width=1024, height=1024,
                  stop={"samples": 1048576})
    api.wait_until(job, lambda snapshot: snapshot["state"] == "rendering")
    start = time.monotonic()
    assert api.daemon.stop() == 0
    assert 2.5 < time.monotonic() - start < 60 * SLOW, "it drains, and not without end"
    api = restarted(api)
    try:
        assert api.state(job)["state"] in ("queued", "preparing", "rendering")
        api.cancel(job)
    finally:
        api.daemon.kill()


def test_sigint_is_like_sigterm(launch):
    api = launch()
    api.daemon.process.send_signal(signal.SIGINT)
    assert api.daemon.process.wait(120 * SLOW) == 0


def test_two_daemons_cannot_share_a_store(launch):
    api = launch()
    try:
        second = Daemon(api.daemon.store)
        second.log_path = second.store.parent / "second.log"
        second.start()
    except AssertionError:
        assert second.process.returncode not in (0, None)
        assert second.process.returncode > 0, "an error, not a crash"
        assert str(api.daemon.store) in second.log
    else:
        second.kill()
        raise AssertionError("a second daemon opened the same store")
    assert api.get("/livez").status_code == 200


def test_same_bytes_for_any_number_of_workers(launch):
    data = scenes.grid_zip(60)
    pictures = []
    for workers, tile in ((1, 64), (2, 64), (7, 64), (2, 1000), (2, 17)):
        api = launch(store=f"store-{workers}-{tile}", workers=workers)
        job = api.job(api.scene(data), width=96, height=64, stop={"samples": 24}, tile=tile)
        assert api.wait(job)["state"] == "completed"
        pictures.append(read_exr(api.image(job, "exr").content).pixels)
        assert api.daemon.stop() == 0
    assert pictures[0].std() > 0.01
    for picture in pictures[1:]:
        assert np.array_equal(pictures[0], picture)
