#!/usr/bin/python3
"""How long a large picture holds up those who wait: its cancel, and every other request meanwhile.

On a real daemon, a picture of the demo scene is rendered until some of it is there, then cancelled; a smaller one is
rendered with one sample and extended by another, from its film where `continued_samples` is 1 (larger ones are over the
1 GiB of films that are kept). All the time another request is made again and again: its longest answer is how long the
scheduler was busy with something else. Prints JSON, in seconds; meant to stay below 0.2.

    tests/bench/server/bench_large_pictures.py [--bin build/test/bin] [--cancelled 3840x2160] [--extended 2400x1500]
"""

import argparse
import http.client
import json
import os
import threading
import time
from pathlib import Path
from types import SimpleNamespace

from bench_daemon_overhead import ROOT, Daemon, submit

PROMISE = 0.2
FINAL = ("completed", "failed", "cancelled")


class Asker(threading.Thread):
    """Asks for the list of jobs; keeps the longest answer since it was last read."""

    def __init__(self, daemon):
        super().__init__(daemon=True)
        self.daemon_, self.longest, self.over = daemon, 0.0, False
        self.start()

    def run(self):
        while not self.over:
            begun = time.monotonic()
            self.daemon_.json("/v1/jobs?limit=1")
            self.longest = max(self.longest, time.monotonic() - begun)
            time.sleep(0.01)

    def read(self):
        longest, self.longest = self.longest, 0.0
        return round(longest, 3)


def post(daemon, path, body=None):
    line = http.client.HTTPConnection("127.0.0.1", daemon.port, timeout=60)
    headers = {"Content-Type": "application/json"} if body is not None else {}
    line.request("POST", path, json.dumps(body) if body is not None else None, headers)
    answer = line.getresponse()
    content = json.loads(answer.read())
    line.close()
    if answer.status >= 300:
        raise SystemExit(f"{path}: {answer.status} {content}")
    return content


def wait(daemon, job, done):
    while not done(seen := daemon.json(f"/v1/jobs/{job}")):
        time.sleep(0.01)
    return seen


def cancelled(daemon, programs, size):
    asker = Asker(daemon)
    job = submit(daemon, programs, SimpleNamespace(size=size, samples=1_000_000))
    wait(daemon, job, lambda s: s["state"] == "rendering")
    answer = {"longest_answer_until_rendering": asker.read()}
    wait(daemon, job, lambda s: s["image"] and s["progress"]["samples_done"] > 0)
    answer["longest_answer_while_rendering"] = asker.read()
    begun = time.monotonic()
    post(daemon, f"/v1/jobs/{job}/cancel")
    answer["cancel_answered"] = round(time.monotonic() - begun, 3)
    wait(daemon, job, lambda s: s["state"] in FINAL)
    answer["cancelled"] = round(time.monotonic() - begun, 3)
    status, _ = daemon.get(f"/v1/jobs/{job}/image?layer=error")  # comes when it is on the disk
    answer |= {"error_layer": round(time.monotonic() - begun, 3), "error_layer_status": status,
               "longest_answer_after_cancel": asker.read()}
    asker.over = True
    return answer


def extended(daemon, programs, size):
    job = submit(daemon, programs, SimpleNamespace(size=size, samples=1))
    if wait(daemon, job, lambda s: s["state"] in FINAL)["state"] != "completed":
        raise SystemExit("the job did not complete")
    asker = Asker(daemon)
    later = post(daemon, f"/v1/jobs/{job}/extend", {"stop": {"samples": 2}})["id"]
    wait(daemon, later, lambda s: s["state"] == "rendering")
    answer = {"longest_answer_until_rendering": asker.read()}
    end = wait(daemon, later, lambda s: s["state"] in FINAL)
    answer |= {"longest_answer_until_completed": asker.read(), "continued_samples": end["continues"]["samples"]}
    asker.over = True
    return answer


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--bin", type=Path, default=ROOT / "build/test/bin", help="where the programs are")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--cancelled", default="3840x2160")
    parser.add_argument("--extended", default="2400x1500")
    options = parser.parse_args()
    daemon = Daemon(options.bin, options.workers)
    try:
        result = {"promise": PROMISE, "load_average": os.getloadavg()[0],
                  options.cancelled: cancelled(daemon, options.bin, options.cancelled),
                  options.extended: extended(daemon, options.bin, options.extended)}
    finally:
        daemon.stop()
    print(json.dumps(result, indent=2))


if __name__ == "__main__":
    main()
