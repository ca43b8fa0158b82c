"""Jobs: life cycle, cancelling, queue bounds, idempotency, requests that cannot be."""

import time

import pytest

from support import scenes
from support.api import problem
from support.daemon import SLOW
from support.patience import eventually, least_of_turns

LONG = {"width": 512, "height": 512, "stop": {"samples": 65536}}
SMALL = {"width": 32, "height": 24, "stop": {"samples": 4}}


def test_life_of_a_job(api, samples):
    answer = api.submit(samples["box"], name="first", seed=7)
    job = answer.json()
    assert answer.headers["Location"] == f"/v1/jobs/{job['id']}"
    final = api.wait(job["id"])
    assert (final["state"], final["error"], final["name"]) == ("completed", None, "first")
    assert final["progress"]["fraction"] == 1
    assert final["progress"]["samples_done"] == 4
    assert final["progress"]["tiles_done"] == final["progress"]["tiles_total"] == 1
    assert final["statistics"]["camera_rays"] == 32 * 24 * 4
    assert final["statistics"]["non_finite_samples"] == 0
    assert final["created_at"] <= final["started_at"] <= final["finished_at"]
    assert final["remaining_seconds"] is None
    assert api.state(job["id"]) == final


def test_the_request_comes_back_with_its_defaults(api, samples):
    request = api.submit(samples["box"]).json()["request"]
    assert request["light_model"] == "physical" and request["max_depth"] == 1024
    assert request["light_model_overrides"] == {}
    assert (request["tile"], request["priority"], request["seed"]) == (64, 10, 0)
    assert (request["branches"], request["emitter_sampling"]) == (1, True)


def test_the_light_model_is_chosen_as_a_whole_and_switch_by_switch(api, samples):
    job = api.submit(samples["box"], light_model="seed", light_model_overrides={"radiance_scaling": True})
    request = job.json()["request"]
    assert request["light_model"] == "seed" and request["max_depth"] == 8
    assert request["light_model_overrides"] == {"radiance_scaling": True}


def test_list_filters_by_state_and_scene(launch):
    api = launch()
    box, other = api.scene(scenes.box_zip()), api.scene(scenes.box_zip("other"))
    jobs = [api.job(box), api.job(other), api.job(box)]
    for job in jobs:
        api.wait(job)
    listed = api.json("/v1/jobs")["jobs"]
    assert [job["id"] for job in listed] == jobs[::-1]
    of_box = api.json("/v1/jobs", params={"scene": box})["jobs"]
    assert [job["id"] for job in of_box] == [jobs[2], jobs[0]]
    assert api.json("/v1/jobs", params={"state": "queued,rendering"})["jobs"] == []
    assert len(api.json("/v1/jobs", params={"state": "completed", "limit": 2})["jobs"]) == 2
    problem(api.get("/v1/jobs", params={"state": "asleep"}), 400, "invalid_parameter")


@pytest.mark.measured
def test_cancel_takes_effect_within_200_ms_and_keeps_the_picture(launch):
    api = launch()
    scene = api.scene(scenes.grid_zip(100))

    def turn():
        job = api.job(scene, **LONG)
        with api.events(job) as stream:
            events = stream.events()
            for event in events:
                if event.data["image"] and event.data["progress"]["samples_done"] >= 1:
                    break
            start = time.monotonic()
            answer = api.cancel(job).json()
            assert answer["state"] in ("cancelling", "cancelled")
            *_, final = events
        assert final.data["state"] == "cancelled"
        assert 0 < final.data["progress"]["fraction"] < 1
        assert final.data["image"], "the partial picture is kept"
        assert len(api.image(job).content) > 1000
        assert api.cancel(job).json()["state"] == "cancelled", "again changes nothing"
        return final.arrived - start

    assert least_of_turns(turn, promised=0.2) <= 0.2


def test_cancel_while_preparing_is_immediate(launch):
    """Each turn with a tree that nobody has built; one that is ready before the first look says nothing."""
    api, cells = launch(), iter(range(400, 800, 20))

    def turn():
        scene = api.scene(scenes.grid_zip(next(cells)))
        job = api.job(scene, **LONG)
        api.wait_until(job, lambda job: job["state"] in ("preparing", "rendering"))
        start = time.monotonic()
        api.cancel(job)
        final = api.wait(job)
        took = time.monotonic() - start
        assert final["state"] == "cancelled"
        return took if final["image"] is None and not final["progress"]["tiles_started"] else float("inf")

    assert least_of_turns(turn, promised=0.2 * SLOW) <= 0.2 * SLOW


def test_a_shared_build_goes_on_for_the_other_job(launch):
    api = launch()
    scene = api.scene(scenes.grid_zip(300))
    first, second = api.job(scene, **LONG), api.job(scene)
    api.cancel(first)
    assert api.wait(first)["state"] == "cancelled"
    assert api.wait(second)["state"] == "completed"


def test_cancel_of_a_queued_job(launch):
    api = launch(workers=1)
    scene = api.scene(scenes.box_zip())
    running, queued = api.job(scene, **LONG), api.job(scene, **LONG)
    for job in (queued, running):
        api.cancel(job)
        assert api.wait(job)["state"] == "cancelled"


def test_cancel_of_a_finished_job_is_refused(api, samples):
    job = api.job(samples["box"])
    api.wait(job)
    problem(api.cancel(job, expect=(409,)), 409, "job_finished")


def test_unknown_jobs(api):
    for method, path in (("GET", ""), ("GET", "/events"), ("GET", "/image"), ("POST", "/cancel")):
        problem(api.request(method, f"/v1/jobs/j_0000{path}"), 404, "job_not_found")


def test_idempotency_key(api, samples):
    headers = {"Idempotency-Key": "build-4711"}
    first = api.submit(samples["box"], headers=headers).json()
    again = api.submit(samples["box"], headers=headers).json()
    assert again["id"] == first["id"]
    other = api.submit(samples["box"], headers=headers, seed=1, expect=(409,))
    problem(other, 409, "idempotency_key_reused")
    for bad in ("x" * 201, "with space", ""):
        answer = api.submit(samples["box"], headers={"Idempotency-Key": bad}, expect=(400,))
        problem(answer, 400, "invalid_parameter")


def test_a_full_queue_says_when_to_come_back(launch):
    api = launch(workers=1, options=["--max-active", "1", "--max-queued", "2"])
    scene = api.scene(scenes.box_zip())
    jobs = [api.job(scene, **LONG) for _ in range(3)]
    refused = api.submit(scene, expect=(429,))
    problem(refused, 429, "queue_full")
    assert 1 <= int(refused.headers["Retry-After"]) <= 3600
    for job in jobs:
        api.cancel(job)
        api.wait(job)
    assert api.wait(api.job(scene))["state"] == "completed", "room again"


def test_priority_shares_the_workers(launch):
    """Both render at once and the one with ten times the weight gets ahead, however late it came."""
    api = launch(workers=1)
    scene = api.scene(scenes.grid_zip(40))
    endless = {"width": 128, "height": 128, "stop": {"samples": 1048576}}
    low = api.job(scene, **endless, priority=10)
    high = api.job(scene, **endless, priority=100)
    done = lambda job: api.state(job)["progress"]["samples_done"]
    eventually(lambda: done(high) >= 16 and 0 < 2 * done(low) < done(high), lambda: f"{done(low)} and {done(high)}")
    for job in (low, high):
        api.cancel(job)


WRONG_FIELDS = [
    ({"colour": 1}, "/colour", "unknown_field"),
    ({"stop": {"samples": 4, "time": 3}}, "/stop/time", "unknown_field"),
    ({"stop": {}}, "/stop", "missing_field"),
    ({"width": "32"}, "/width", "wrong_type"),
    ({"width": 32.5}, "/width", None),
    ({"width": 0}, "/width", "out_of_range"),
    ({"height": 16385}, "/height", "out_of_range"),
    ({"width": 10**30}, "/width", None),
    ({"width": -1}, "/width", "out_of_range"),
    ({"stop": {"samples": 0}}, "/stop/samples", "out_of_range"),
    ({"stop": 4}, "/stop", "wrong_type"),
    ({"max_depth": 1025}, "/max_depth", "out_of_range"),
    ({"light_model": "nature"}, "/light_model", None),
    ({"light_model_overrides": {"phong": "half"}}, "/light_model_overrides/phong", "invalid_value"),
    ({"light_model_overrides": {"colour": True}}, "/light_model_overrides/colour", "unknown_field"),
    ({"light_model_overrides": {"roulette": 1}}, "/light_model_overrides/roulette", "wrong_type"),
    ({"tile": 0}, "/tile", "out_of_range"),
    ({"priority": 0}, "/priority", "out_of_range"),
    ({"seed": -1}, "/seed", "out_of_range"),
    ({"camera": {"eye": [0, 0, 1]}}, "/camera/look_at", "missing_field"),
    ({"camera": {"eye": [0, 0], "look_at": [0, 0, 0]}}, "/camera/eye", None),
    ({"camera": {"eye": [0, 0, 1], "look_at": [0, 0, 0], "lens": 1}}, "/camera/lens", "unknown_field"),
    ({"name": "a\u0007b"}, "/name", "invalid_value"),
]


@pytest.mark.parametrize("fields, pointer, code", WRONG_FIELDS, ids=lambda v: str(v)[:40])
def test_wrong_fields_are_named(api, samples, fields, pointer, code):
    body = problem(api.submit(samples["box"], expect=(422,), **fields), 422, "invalid_request")
    found = {entry["pointer"]: entry["code"] for entry in body["errors"]}
    assert pointer in found, found
    assert code is None or found[pointer] == code


def test_every_wrong_field_is_reported_at_once(api, samples):
    answer = api.submit(samples["box"], expect=(422,), width=0, height=0, colour=1)
    assert len(problem(answer, 422, "invalid_request")["errors"]) == 3


@pytest.mark.parametrize("camera", [
    {"eye": [0, 0, 0], "look_at": [0, 0, 0]},
    {"eye": [0, 0, 1], "look_at": [0, 0, 0], "up": [0, 0, 1]},
    {"eye": [0, 0, 1], "look_at": [0, 0, 0], "fov_deg": 180},
    99, "no such camera",
], ids=str)
def test_cameras_that_see_nothing(api, samples, camera):
    problem(api.submit(samples["box"], expect=(422,), camera=camera), 422, "invalid_request")


def test_a_film_beyond_the_limit(api, samples):
    answer = api.submit(samples["box"], expect=(422,), width=16384, height=16384)
    problem(answer, 422, "film_too_large")


def test_an_unknown_scene(api):
    problem(api.submit("0" * 64, expect=(404,)), 404, "scene_not_found")


@pytest.mark.parametrize("body", [b"", b"{", b"[]", b"null", b'{"a":1}{', b"\xff\xfe", b"[" * 100000,
                                  b'{"width":1,"width":2}'], ids=lambda b: repr(b[:12]))
def test_bodies_that_are_no_request(api, body):
    answer = api.request("POST", "/v1/jobs", data=body,
                         headers={"Content-Type": "application/json"})
    assert answer.status_code in (400, 422), answer.text
    detail = problem(answer, answer.status_code, answer.json()["code"])["detail"]
    assert detail == detail.strip()


def test_a_json_body_beyond_its_limit(api):
    answer = api.request("POST", "/v1/jobs", data=b" " * (256 * 1024 + 1),
                         headers={"Content-Type": "application/json"})
    problem(answer, 413, "payload_too_large")
