"""`reuse`: an equal request is answered with the picture that is there."""

import re
import sqlite3

from support import scenes


def counter(api, name):
    found = re.search(rf"^{name} ([-+.\de]+)$", api.get("/metrics").text, re.M)
    assert found, f"no {name} at /metrics"
    return float(found.group(1))


def test_an_equal_job_renders_nothing(launch):
    api = launch()
    scene = api.scene(scenes.box_zip("reuse"))
    first = api.job(scene, reuse=True)
    picture = (api.wait(first), api.image(first).content)[1]
    samples = counter(api, "raykiln_samples_total")
    assert samples == 32 * 24 * 4
    again = api.submit(scene, expect=(200,), reuse=True, name="other", priority=3)
    assert again.json()["id"] == first and again.headers["Location"] == f"/v1/jobs/{first}"
    assert again.json()["state"] == "completed" and api.image(first).content == picture
    assert counter(api, "raykiln_samples_total") == samples
    assert counter(api, "raykiln_results_reused_total") == 1
    for change in ({"seed": 1}, {"width": 33}, {"max_depth": 2}, {"light_model": "seed"}):
        api.submit(scene, expect=(202,), reuse=True, **change)
    assert api.submit(scene, expect=(202,)).json()["id"] != first, "nobody asked for reuse"


def test_it_outlives_the_daemon_and_stores_of_before(launch):
    api = launch()
    scene = api.scene(scenes.box_zip("reuse"))
    first = api.job(scene)
    api.wait(first)
    assert api.daemon.stop() == 0
    api.daemon.start()
    assert api.submit(scene, expect=(200,), reuse=True).json()["id"] == first
    assert counter(api, "raykiln_samples_total") == 0
    # A store as a version before this one left it: jobs without the digest of their results.
    assert api.daemon.stop() == 0
    with sqlite3.connect(api.daemon.store / "raykiln.db") as base:
        base.execute("DROP INDEX jobs_by_result")
        base.execute("ALTER TABLE jobs DROP COLUMN result")
        base.execute("PRAGMA user_version = 1")
    base.close()
    api.daemon.start()
    assert api.state(first)["state"] == "completed"
    second = api.submit(scene, expect=(202,), reuse=True).json()["id"]
    api.wait(second)
    assert api.submit(scene, expect=(200,), reuse=True).json()["id"] == second
