"""Many clients at once who submit, cancel, watch and fetch: every job ends once, and the daemon is as before."""

import random
import threading

from support.api import FINAL, Api
from support.daemon import fewer


def test_submits_and_cancels_at_once(launch, tmp_path):
    api = launch(options=["--max-queued", "40"])
    from support import scenes
    scene = api.scene(scenes.box_zip("crowd"))
    faults, jobs, lock = [], [], threading.Lock()

    def client(number):
        dice, mine = random.Random(number), Api(api.daemon)
        for _ in range(12):
            answer = mine.submit(scene, expect=(202, 429), width=64, height=48, priority=dice.randint(1, 100),
                                 stop={"samples": dice.choice([1, 8, 4096])})
            if answer.status_code == 429:
                assert int(answer.headers["Retry-After"]) >= 1
                continue
            job = answer.json()["id"]
            with lock:
                jobs.append(job)
            for _ in range(dice.randint(1, 4)):
                what = dice.choice(["cancel", "image", "state", "sample"])
                if what == "cancel":
                    mine.cancel(job, expect=(202, 409))
                elif what == "image":
                    mine.image(job, expect=(200, 404))
                elif what == "sample":
                    code = mine.get(f"/v1/jobs/{job}/samples?x=3&y=4&sample=5").status_code
                    assert code in (200, 429, 503), code
                else:
                    mine.state(job)
            mine.cancel(job, expect=(202, 409))

    def guarded(number):
        try:
            client(number)
        except Exception as fault:  # a thread's failure is the test's
            faults.append(repr(fault))

    threads = [threading.Thread(target=guarded, args=(number,)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not faults, faults[:3]
    assert len(jobs) > 20
    ends = {job: api.wait(job) for job in jobs}
    assert {end["state"] for end in ends.values()} <= {"completed", "cancelled"}
    # Final states stay, over a kill too.
    api.daemon.kill()
    api.daemon.start()
    for job, end in ends.items():
        again = api.state(job)
        assert again["state"] in FINAL and (again["state"], again["revision"]) == (end["state"], end["revision"])


def test_kill_and_start_again_under_load(launch):
    """Three times in a row, with jobs in every stage: all that was accepted ends, none is lost."""
    api = launch()
    from support import scenes
    scene, jobs = api.scene(scenes.box_zip("again")), []
    for round_ in range(3):
        for samples in (1, fewer(64), fewer(512)):
            jobs.append(api.job(scene, width=96, height=64, stop={"samples": samples}, seed=round_))
        cancelled = api.job(scene, width=96, height=64, stop={"samples": 1048576})
        api.cancel(cancelled)
        jobs.append(cancelled)
        api.daemon.kill()
        api.daemon.start()
    ends = [api.wait(job)["state"] for job in jobs]
    assert ends == ["completed", "completed", "completed", "cancelled"] * 3
