"""What ends a job: samples, time or error; and what it says of its accuracy."""

from support.api import problem

TINY = {"width": 32, "height": 24, "tile": 8}


def ended(api, scene, stop, **changes):
    return api.wait(api.submit(scene, **{**TINY, "stop": stop, **changes}).json()["id"])


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
