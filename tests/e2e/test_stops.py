"""What ends a job: samples, time or error; and what it says of its accuracy."""

from support.api import problem
from support.daemon import SLOW
from support.image_files import read_exr, read_png

TINY = {"width": 32, "height": 24, "tile": 8}
LAYERS = ["albedo", "depth", "direct", "indirect"]


def ended(api, scene, stop, **changes):
    return api.wait(api.submit(scene, **{**TINY, "stop": stop, **changes}).json()["id"])


def layers_of(api, job):
    """The bytes of each channel of a job's layers. Pixels have other numbers of samples: each divides by its own."""
    exr = read_exr(api.image(job["id"], "exr").content, every=True)
    channels = {name: exr.pixels[..., i] for i, name in enumerate(exr.channels) if name == "Z" or "." in name}
    light = sum(channels[f"{name}.G"].astype(float) for name in ("direct", "indirect"))
    assert (channels["albedo.R"] <= 1).all() and (light >= 0).all() and light.max() > 0
    return {name: plane.tobytes() for name, plane in channels.items()}


def test_an_error_target_is_met_by_the_upper_end_of_the_interval(api, samples):
    job = ended(api, samples["box"], {"error": 0.05})
    assert job["state"] == "completed" and job["done_by"] == "error", job
    accuracy = job["accuracy"]
    assert accuracy["error"]["low"] <= accuracy["error"]["value"] <= accuracy["error"]["high"] <= 0.05
    assert accuracy["target_reached"] is True and accuracy["grade"] == "measured"
    assert job["progress"]["fraction"] == 1
    assert job["request"]["stop"] == {"samples": 1048576, "seconds": 3600, "error": 0.05}


def test_time_ends_a_job_and_says_that_the_target_was_not_reached(api, samples):
    job = ended(api, samples["box"], {"seconds": 0.3, "error": 0.0001})
    assert job["done_by"] == "seconds" and job["accuracy"]["target_reached"] is False
    assert job["statistics"]["render_seconds"] >= 0.3
    assert job["progress"]["fraction"] == 1


def test_a_job_by_samples_knows_its_error(api, samples):
    job = ended(api, samples["box"], {"samples": 64})
    assert job["done_by"] == "samples" and job["accuracy"]["target"] is None
    assert job["accuracy"]["error"]["value"] > 0
    rough = ended(api, samples["box"], {"samples": 4})
    assert "error_rough" in rough["accuracy"]["notices"]
    unknown = ended(api, samples["box"], {"samples": 1})
    assert unknown["accuracy"]["grade"] == "unknown" and unknown["accuracy"]["error"] is None


def test_adaptive_jobs_say_so_everywhere_and_are_made_again(api, samples):
    job = ended(api, samples["box"], {"error": 0.01}, adaptive=True, layers=LAYERS, width=64, height=48)
    assert job["done_by"] == "error" and "adaptive" in job["accuracy"]["notices"]
    assert job["request"]["adaptive"] is True and job["request"]["tile"] == 16
    exr = api.image(job["id"], "exr").content[:2000]
    assert b"raykiln:adaptive" in exr and b"adaptive sampling" in api.image(job["id"]).content
    each = api.json(f"/v1/jobs/{job['id']}/accuracy")["tile_samples"]
    assert len(each) == 12 and 64 <= min(each) < max(each)  # where they are even there is no list
    again = ended(api, samples["box"], {"tile_samples": each}, tile=16, layers=LAYERS, width=64, height=48)
    assert "adaptive" not in again["accuracy"]["notices"]
    assert b"adaptive sampling" not in api.image(again["id"]).content
    assert (read_png(api.image(again["id"]).content).pixels == read_png(api.image(job["id"]).content).pixels).all()
    assert layers_of(api, job) == layers_of(api, again) != {}
    body = problem(api.submit(samples["box"], expect=(422,), **{**TINY, "adaptive": True, "stop": {"samples": 8}}), 422, "invalid_request")
    assert [error["pointer"] for error in body["errors"]] == ["/adaptive"]


def test_stops_that_cannot_be(api, samples):
    def pointers(stop):
        body = problem(api.submit(samples["box"], expect=(422,), **{**TINY, "stop": stop}), 422, "invalid_request")
        return [error["pointer"] for error in body.get("errors", [])] or [body.get("where")]

    assert pointers({}) == ["/stop"]
    assert pointers({"seconds": 0}) == ["/stop/seconds"]
    assert pointers({"seconds": 1e9}) == ["/stop/seconds"]
    assert pointers({"error": -1}) == ["/stop/error"]
    assert pointers({"error": 1e-9}) == ["/stop/error"]
    assert pointers({"tile_samples": [1, 2]}) == ["/stop/tile_samples"]
    assert pointers({"tile_samples": "all"}) == ["/stop/tile_samples"]
    assert pointers({"tile_samples": [1] * 12, "error": 0.1}) == ["/stop/tile_samples"]


def extend(api, job, body, expect=(202,), **options):
    return api.post(f"/v1/jobs/{job['id']}/extend", body, expect, **options)


def test_a_completed_job_goes_on_to_the_same_picture(api, samples):
    early = ended(api, samples["box"], {"samples": 20})
    answer = extend(api, early, {"stop": {"samples": 50}})
    late = api.wait(answer.json()["id"])
    assert answer.headers["Location"] == f"/v1/jobs/{late['id']}"
    assert late["state"] == "completed" and late["continues"] == {"job": early["id"], "samples": 16}
    assert early["continues"] is None
    whole = ended(api, samples["box"], {"samples": 50})
    pictures = [api.get(f"/v1/jobs/{job['id']}/image?format=png").content for job in (late, whole)]
    assert pictures[0] == pictures[1]
    wrong = problem(extend(api, late, {"stop": {"samples": 50}}, expect=(422,)), 422, "invalid_request")
    assert [error["pointer"] for error in wrong["errors"]] == ["/stop/samples"]
    assert problem(extend(api, late, {"stop": {}}, expect=(422,)), 422, "invalid_request")["errors"]
    assert problem(extend(api, late, {"stop": {"samples": 99}, "width": 3}, expect=(422,)), 422, "invalid_request")


def test_a_quote_has_prices_that_hold_and_its_samples_are_kept(api, samples):
    for seconds in (0.4, 2, 10, 50):  # until a busy machine has had the time to learn something
        body = {"scene": samples["box"], **TINY, "pilot_seconds": seconds * SLOW}
        answer = api.post("/v1/quotes", body)
        assert answer.headers["Location"] == f"/v1/quotes/{answer.json()['id']}"
        pilot = api.wait(answer.json()["id"])
        quote = api.get(answer.headers["Location"]).json()
        assert quote["state"] == "completed"
        if quote["error"] and quote["pilot"]["samples"] > 128:
            break
    assert quote["pilot"]["samples"] > 128
    prices = quote["prices"]
    assert [price["error"] for price in prices] == [0.1, 0.05, 0.02, 0.01, 0.005]
    assert all(p["seconds"]["low"] <= p["seconds"]["value"] <= p["seconds"]["high"] for p in prices)
    assert all(p["seconds_left"]["value"] == 0 for p in prices if p["reached"] and p["seconds"]["value"] < quote["pilot"]["seconds"])
    bought = api.wait(extend(api, pilot, {"stop": {"error": max(0.02, quote["error"]["value"] / 1.5)}}).json()["id"])
    assert bought["done_by"] == "error" and bought["continues"]["samples"] > 64
    assert problem(api.post("/v1/quotes", {**body, "stop": {"samples": 3}}, (422,)), 422, "invalid_request")
    assert problem(api.post("/v1/quotes", {**body, "pilot_seconds": 1e4}, (422,)), 422, "invalid_request")
