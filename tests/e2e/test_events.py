"""Server-sent events: snapshots, order, the final state, readers that are slow or many."""

import json
import statistics
import threading
import time

import pytest

from support import scenes
from support.api import FINAL
from support.daemon import SLOW, fewer
from support.patience import PATIENCE, eventually, least_of_turns


def test_the_first_event_is_a_full_snapshot_and_ids_rise(api, samples):
    job = api.job(samples["grid"], width=256, height=256, stop={"samples": fewer(32)})
    with api.events(job) as stream:
        events = list(stream.events())
    assert stream.headers["content-type"].split(";")[0] == "text/event-stream"
    assert all(event.kind == "job" and set(event.data) >= {"id", "state", "progress", "statistics",
                                                           "request", "image"} for event in events)
    revisions = [int(event.id) for event in events]
    assert revisions == sorted(set(revisions)), "revisions rise strictly"
    assert revisions == [event.data["revision"] for event in events]
    assert [event.data["state"] in FINAL for event in events[-2:]][-1:] == [True]
    assert not any(event.data["state"] in FINAL for event in events[:-1])
    fractions = [event.data["progress"]["fraction"] for event in events]
    assert fractions == sorted(fractions) and fractions[-1] == 1


def test_at_most_ten_events_a_second(api, samples):
    job = api.job(samples["grid"], width=256, height=256, stop={"seconds": 1.5})
    begun = time.monotonic()  # events that wait while this process does arrive together
    with api.events(job) as stream:
        times = [event.arrived for event in stream.events()]
    assert len(times) >= 3
    assert len(times) <= 4 + 10.5 * (times[-1] - begun)


def test_a_finished_job_gives_its_final_state_at_once(api, samples):
    job = api.job(samples["box"])
    final = api.wait(job)
    with api.events(job) as stream:
        events = list(stream.events())
    assert [event.data for event in events] == [final]


def test_last_event_id_of_the_final_state_ends_with_204(api, samples):
    job = api.job(samples["box"])
    revision = api.wait(job)["revision"]
    seen = api.get(f"/v1/jobs/{job}/events", headers={"Last-Event-ID": str(revision)})
    assert (seen.status_code, seen.content) == (204, b"")
    for older in (str(revision - 1), "nonsense", "-1", "9" * 40):
        with api.events(job, last_event_id=older) as stream:
            assert stream.last().data["state"] == "completed"


def test_reconnecting_in_the_middle_starts_with_the_newest(launch):
    api = launch()
    job = api.job(api.scene(scenes.grid_zip(60)), width=512, height=512, stop={"samples": 65536})
    with api.events(job) as stream:
        first = next(stream.events())
    later = api.wait_until(job, lambda snapshot: snapshot["revision"] > int(first.id) + 2)
    with api.events(job, last_event_id=first.id) as stream:
        event = next(stream.events())
    assert int(event.id) >= later["revision"]
    api.cancel(job)


def test_heartbeat_in_silence(launch):
    """A queued job behind a running one says nothing; the stream shows a sign of life."""
    api = launch(workers=1)
    scene = api.scene(scenes.box_zip())
    job = api.job(scene, width=1, height=1, stop={"samples": 1048576}, max_depth=64)
    with api.events(job, timeout=60 * SLOW) as stream:
        for event in stream.events():
            if stream.comments or event.data["state"] in FINAL:
                break
    # Either the job was never silent for 10 s, or a comment line came; what must not happen is
    # the socket's timeout, which is an exception above. When it comes is a matter of unit/http.
    api.request("POST", f"/v1/jobs/{job}/cancel")


@pytest.mark.measured
def test_a_reader_that_never_reads_slows_nothing_and_gets_the_final_state(launch):
    api = launch()
    scene = api.scene(scenes.grid_zip(60))
    request = {"width": 400, "height": 300, "stop": {"samples": 32}}
    alone, watched = [], []

    def turn():
        alone.append(api.wait(api.job(scene, **request))["elapsed_seconds"])
        job = api.job(scene, **request)
        stalled = [api.events(job, receive_buffer=2048) for _ in range(20)]
        final = api.wait(job)
        watched.append(final["elapsed_seconds"])
        for stream in stalled:
            with stream:
                assert stream.last().data["revision"] == final["revision"]
        return min(watched) - 1.25 * min(alone)

    assert least_of_turns(turn, promised=0.25) <= 0.25, (alone, watched)


@pytest.mark.measured
def test_memory_of_many_readers_is_bounded(launch):
    api = launch(options=["--max-connections", "600", "--max-watchers", "500"])
    job = api.job(api.scene(scenes.grid_zip(60)), width=256, height=256,
                  stop={"samples": 1048576})
    api.wait_until(job, lambda snapshot: snapshot["image"])
    # What rendering, encoding and the first readers need once is there before the count begins.
    few, count = readers_of(api, job, 20), 400
    before = steady_kib(api, job)
    streams = few + readers_of(api, job, count)
    after = steady_kib(api, job)
    # What grows without end grows in most turns. A turn may meet with the allocator, or with a program that took the time from
    # this one; the median does not see it, but it sees half a kilobyte a reader and revision.
    turns, revisions = 5, 6
    peaks = [peak_kib(api, job, revisions) for _ in range(turns + 1)]
    growth = statistics.median(later - earlier for earlier, later in zip(peaks, peaks[1:]))
    assert (after - before) / count <= 64, f"{(after - before) / count:.0f} KiB a client"
    assert growth <= count * revisions / 2, f"grows by {growth} KiB in {revisions} revisions: {peaks}"
    api.cancel(job)
    for stream in streams:
        assert stream.last().data["state"] == "cancelled"
        stream.close()


def readers_of(api, job, count):
    """Readers that have read the head of the answer and read no more."""
    streams = [api.events(job, receive_buffer=2048) for _ in range(count)]
    for stream in streams:
        stream.read_head()
    return streams


def steady_kib(api, job, most_looks=20) -> int:
    """The peak once it has stopped growing: the allocator keeps what the first pictures took."""
    peak = peak_kib(api, job)
    for _ in range(most_looks):
        again = peak_kib(api, job)
        if again <= peak + 512:
            return max(peak, again)
        peak = again
    return peak


def peak_kib(api, job, revisions=20) -> int:
    """The most while the job came so much further, however long that took."""
    api.daemon.reset_peak()
    begun = api.state(job)["revision"]
    api.wait_until(job, lambda snapshot: snapshot["revision"] >= begun + revisions)
    return api.daemon.status_kib("VmHWM")


def test_the_stream_ends_without_a_final_event_when_the_server_stops(launch):
    api = launch()
    job = api.job(api.scene(scenes.grid_zip(60)), width=512, height=512,
                  stop={"samples": 1048576})
    seen = []

    def read():
        with api.events(job) as stream:
            seen.extend(event.data["state"] for event in stream.events())

    reader = threading.Thread(target=read)
    reader.start()
    api.wait_until(job, lambda snapshot: snapshot["state"] == "rendering")
    eventually(lambda: seen)
    assert api.daemon.stop() == 0
    reader.join(PATIENCE * SLOW)
    assert not reader.is_alive() and seen and not set(seen) & set(FINAL), json.dumps(seen)
