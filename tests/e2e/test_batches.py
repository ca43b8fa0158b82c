"""/v1/batches: many pictures on the daemon, together."""

import pytest

from support import scenes
from support.api import problem
from support.daemon import SLOW
from support.sse import EventStream
from test_reuse import counter

SMALL = {"width": 32, "height": 24, "stop": {"samples": 4}}
ENDLESS = {"width": 256, "height": 256, "stop": {"samples": 1048576}}


def send(api, *entries, expect=202, key=None, **fields):
    body = {"defaults": SMALL, **fields, "scenes": list(entries)}
    headers = {"Idempotency-Key": key} if key else None
    answer = api.request("POST", "/v1/batches", json=body, headers=headers)
    assert answer.status_code == expect, answer.text
    return answer.json()


def get(api, batch):
    return api.json(f"/v1/batches/{batch}")


def events(api, batch, **options):
    return EventStream(api.daemon.port, f"/v1/batches/{batch}/events", timeout=180 * SLOW, **options)


def wait(api, batch):
    with events(api, batch) as stream:
        seen = [event for event in stream.events()]
    revisions = [event.data["revision"] for event in seen]
    assert revisions == sorted(set(revisions)) and all(e.id == str(e.data["revision"]) for e in seen)
    assert seen[-1].data == get(api, batch)
    return seen[-1].data


def states(batch):
    return {item["name"]: item["state"] for item in batch["items"]}


def post(api, batch, what, expect=202):
    answer = api.request("POST", f"/v1/batches/{batch}/{what}")
    assert answer.status_code == expect, answer.text
    return answer.json()


def test_a_matrix_is_spread_out_and_a_bad_scene_fails_alone(launch):
    api = launch()
    box, other = api.scene(scenes.box_zip("a")), api.scene(scenes.box_zip("b"))
    asked = api.request("POST", "/v1/missing-scenes", json={"scenes": [box, "2" * 64, other, "2" * 64]})
    assert asked.json() == {"missing": ["2" * 64]}
    top = {"name": "top", "eye": [0, 5, 0.1], "look_at": [0, 0, 0]}
    batch = send(api, {"scene": box, "name": "box", "cameras": [0, top],
                       "settings": [{"name": "low"}, {"name": "high", "stop": {"samples": 8}}]},
                 {"scene": other, "name": "other one"}, {"scene": "2" * 64, "name": "gone"},
                 {"scene": other, "name": "camera", "settings": [{"camera": "nobody"}]}, name="six", priority=3)
    assert batch["state"] == "running" and batch["counts"]["total"] == 7
    end = wait(api, batch["id"])
    assert end["state"] == "failed" and end["finished_at"]
    assert states(end) == {"box-0-low": "completed", "box-0-high": "completed", "box-top-low": "completed",
                           "box-top-high": "completed", "other_one": "completed", "gone": "failed", "camera": "failed"}
    by_name = {item["name"]: item for item in end["items"]}
    assert by_name["gone"]["error"]["code"] == "scene_not_found" and by_name["gone"]["job"] is None
    assert by_name["camera"]["error"]["code"] == "invalid_request"
    job = api.state(by_name["box-top-high"]["job"])
    assert job["request"]["stop"] == {"samples": 8} and job["request"]["camera"]["eye"] == [0, 5, 0.1]
    assert job["name"] == "box-top-high" and job["request"]["priority"] == 3
    counts = end["counts"]
    assert (counts["completed"], counts["failed"], counts["reused"]) == (5, 2, 0)
    # What failed is tried again when what it lacked is there; the rest stays as it was.
    assert post(api, batch["id"], "rerun")["counts"]["completed"] == 5
    again = wait(api, batch["id"])
    assert {item["name"]: item["attempt"] for item in again["items"]} == {
        name: 2 if name in ("gone", "camera") else 1 for name in by_name}
    assert {item["name"]: item["job"] for item in again["items"]} == {name: item["job"] for name, item in by_name.items()}
    assert states(again) == states(end)


def test_what_is_wrong_with_a_batch_is_said_at_once(api, samples):
    box = samples["box"]

    def refused(*entries, **fields):
        body = {"defaults": SMALL, **fields, "scenes": list(entries)}
        found = problem(api.request("POST", "/v1/batches", json=body), 422, "invalid_request")
        return {error["pointer"]: error["code"] for error in found["errors"]}

    assert refused() == {"/scenes": "invalid_value"}
    assert refused({"scene": box, "name": "a"}, {"scene": box, "name": "a"}) == {"/scenes/1": "invalid_value"}
    assert refused({"scene": "x", "name": "a"}) == {"/scenes/0/scene": "invalid_value"}
    assert refused({"scene": box, "name": "a", "settings": [{"width": 0}, {"name": "b", "colour": 1}]}) == {
        "/scenes/0/settings/0/width": "out_of_range", "/scenes/0/settings/1/colour": "unknown_field"}
    assert refused({"scene": box, "name": "a"}, max_active=0, speed=1) == {
        "/max_active": "out_of_range", "/speed": "unknown_field"}
    assert refused({"scene": box, "name": "a", "settings": [{"priority": 1}]}) == {
        "/scenes/0/settings/0/priority": "unknown_field"}
    many = {"cameras": list(range(40)), "settings": [{"name": str(n)} for n in range(40)]}
    assert "/scenes" in refused({"scene": box, "name": "a", **many})
    assert "/defaults" in refused({"scene": box, "name": "a"}, defaults={**SMALL, "x": "y" * 5000})
    problem(api.get("/v1/batches/b_none"), 404, "batch_not_found")
    problem(api.get("/v1/batches", params={"cursor": "b_none"}), 400, "invalid_parameter")


def test_a_key_makes_one_batch(launch):
    api = launch()
    entry = {"scene": api.scene(scenes.box_zip("key")), "name": "box"}
    first = send(api, entry, key="k")
    assert send(api, entry, key="k")["id"] == first["id"]
    send(api, {**entry, "name": "other"}, key="k", expect=409)
    wait(api, first["id"])
    assert send(api, entry, key="k")["state"] == "completed"
    listed = api.json("/v1/batches")["batches"]
    assert [b["id"] for b in listed] == [first["id"]] and "items" not in listed[0]


def test_lists_newest_first_in_pages(launch):
    api = launch()
    entry = {"scene": api.scene(scenes.box_zip("list")), "name": "box"}
    made = [send(api, entry, name=str(n))["id"] for n in range(3)][::-1]
    one = api.json("/v1/batches", params={"limit": 2})
    assert [b["id"] for b in one["batches"]] == made[:2]
    two = api.json("/v1/batches", params={"limit": 2, "cursor": one["next_cursor"]})
    assert [b["id"] for b in two["batches"]] == made[2:] and two["next_cursor"] is None


def test_jobs_at_once_are_limited_and_a_cancel_ends_all(launch):
    api = launch()
    box = api.scene(scenes.box_zip("cancel"))
    entries = [{"scene": box, "name": f"p{n}", "settings": [{"seed": n}]} for n in range(5)]
    batch = send(api, *entries, defaults=ENDLESS, max_active=2)["id"]
    with events(api, batch) as stream:
        for event in stream.events():
            assert event.data["counts"]["active"] <= 2
            if all(item["job"] for item in event.data["items"][:2]):
                break
    problem(api.request("POST", f"/v1/batches/{batch}/rerun"), 409, "batch_running")
    assert api.json("/v1/jobs")["jobs"].__len__() == 2
    post(api, batch, "cancel")
    end = wait(api, batch)
    assert end["state"] == "cancelled" and set(states(end).values()) == {"cancelled"}
    assert post(api, batch, "cancel")["state"] == "cancelled"
    last = str(end["revision"])
    assert api.get(f"/v1/batches/{batch}/events", headers={"Last-Event-ID": last}).status_code == 204


def test_fail_fast_skips_what_waits(launch):
    api = launch()
    box = api.scene(scenes.box_zip("fast"))
    entries = [{"scene": "3" * 64, "name": "gone"}] + [{"scene": box, "name": f"p{n}"} for n in range(3)]
    end = wait(api, send(api, *entries, fail_fast=True, max_active=1)["id"])
    assert states(end) == {"gone": "failed", "p0": "skipped", "p1": "skipped", "p2": "skipped"}


@pytest.mark.parametrize("end", ["stop", "kill"])
def test_survives_the_daemon(launch, end):
    api = launch()
    box = api.scene(scenes.box_zip("restart"))
    entries = [{"scene": box, "name": f"p{n}", "settings": [{"seed": n}]} for n in range(4)]
    done = send(api, *entries)["id"]
    before = wait(api, done)
    long = {"width": 128, "height": 96, "stop": {"samples": 3000}}
    batch = send(api, *entries, defaults=long, max_active=1, key="long")["id"]
    with events(api, batch) as stream:
        next(e for e in stream.events() if e.data["items"][0]["job"])
    jobs = {item["name"]: item["job"] for item in get(api, batch)["items"] if item["job"]}
    getattr(api.daemon, end)()
    api.daemon.start()
    assert get(api, done) == before
    assert send(api, *entries, defaults=long, max_active=1, key="long")["id"] == batch
    with events(api, batch) as stream:
        next(e for e in stream.events() if e.data["items"][0]["job"])
    after = {item["name"]: item["job"] for item in get(api, batch)["items"] if item["job"]}
    assert jobs.items() <= after.items(), "the jobs of before, no new ones"
    post(api, batch, "cancel")
    assert wait(api, batch)["state"] in ("cancelled",)


def test_an_unchanged_batch_renders_nothing(launch):
    api = launch()
    ids = [api.scene(scenes.box_zip(f"reuse {n}")) for n in range(20)]
    entries = [{"scene": one, "name": f"p{n}"} for n, one in enumerate(ids)]
    first = wait(api, send(api, *entries, max_active=16)["id"])
    rendered = counter(api, "raykiln_samples_total")
    assert rendered == 20 * 32 * 24 * 4
    second = wait(api, send(api, *entries)["id"])
    assert second["state"] == "completed" and second["counts"]["reused"] == 20
    assert counter(api, "raykiln_samples_total") == rendered
    assert [i["job"] for i in second["items"]] == [i["job"] for i in first["items"]]
    third = wait(api, send(api, *entries[:2], reuse=False)["id"])
    assert third["counts"]["reused"] == 0 and counter(api, "raykiln_samples_total") == rendered * 1.1
