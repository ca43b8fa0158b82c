#!/usr/bin/python3
"""What a job costs beside its rendering, on a real daemon that is being watched.

Starts raykilnd with a store of its own, submits the demo scene, follows the events and fetches
the newest picture as the page does, and prints JSON: (idle + merge + publish) / worker seconds,
which is meant to stay below 2 %, and how long tasks were, meant to last 5 to 50 ms. As a check
from outside, `share_not_rendering` is what workers x wall time of the render leave unexplained.

    tests/bench/server/bench_daemon_overhead.py [--bin build/test/bin] [--runs 3] [--no-watcher]

Times wander on a shared machine: `load_average` and `cpu_per_worker_second` (below 1: others
took the processor away) say how far to trust them. `scheduler_cpu_share` and
`http_and_disk_cpu_share` are processor seconds over those of the workers, and wander less.
"""

import argparse
import http.client
import json
import os
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
PROMISE = 0.02


class Daemon:
    def __init__(self, programs, workers, *more):
        self.folder = tempfile.TemporaryDirectory(prefix="raykiln-bench-")
        ready = Path(self.folder.name) / "ready"
        log = open(Path(self.folder.name) / "log", "wb")
        self.process = subprocess.Popen(
            [str(programs / "raykilnd"), "--listen", "127.0.0.1:0", "--workers", str(workers),
             "--store", str(Path(self.folder.name) / "store"), "--ready-file", str(ready), *more],
            stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        deadline = time.monotonic() + 20
        while not ready.exists():
            if self.process.poll() is not None or time.monotonic() > deadline:
                raise SystemExit("raykilnd did not start; is another build in --bin?")
            time.sleep(0.02)
        self.url = ready.read_text().strip()
        self.port = int(self.url.rsplit(":", 1)[1])

    def stop(self):
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(30)
        self.folder.cleanup()

    def get(self, path):
        line = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        line.request("GET", path)
        answer = line.getresponse()
        body = answer.read()
        line.close()
        return answer.status, body

    def json(self, path):
        status, body = self.get(path)
        if status != 200:
            raise SystemExit(f"{path}: {status} {body[:300]!r}")
        return json.loads(body)

    def cpu_seconds(self):
        """By what a thread does, from /proc: rendering, scheduling, and all others (HTTP, disk)."""
        spent = {"render": 0.0, "scheduler": 0.0, "others": 0.0}
        for task in Path(f"/proc/{self.process.pid}/task").iterdir():
            name = (task / "comm").read_text().split("-")[0].strip()
            fields = (task / "stat").read_text().rsplit(")", 1)[1].split()
            ticks = int(fields[11]) + int(fields[12])
            spent[name if name in spent else "others"] += ticks / os.sysconf("SC_CLK_TCK")
        return spent

    def tasks(self):
        """Sum, count and buckets {upper bound in seconds: count} of all tasks so far."""
        text = self.get("/metrics")[1].decode()
        buckets = {float(le): int(n) for le, n in
                   re.findall(r'^raykiln_task_seconds_bucket\{le="([0-9.e-]+)"\} (\d+)', text, re.M)}
        total = float(re.search(r"^raykiln_task_seconds_sum (\S+)", text, re.M).group(1))
        count = int(re.search(r"^raykiln_task_seconds_count (\d+)", text, re.M).group(1))
        return total, count, buckets


class Watcher(threading.Thread):
    """Reads every event and fetches the newest picture at the page's pace (web/src/image_policy.ts)."""

    def __init__(self, daemon, job):
        super().__init__(daemon=True)
        self.daemon_, self.job = daemon, job
        self.events = self.pictures = self.bytes = 0
        self.next_picture = 0.0
        self.start()

    def run(self):
        line = http.client.HTTPConnection("127.0.0.1", self.daemon_.port, timeout=60)
        line.request("GET", f"/v1/jobs/{self.job}/events")
        for text in line.getresponse():
            if not text.startswith(b"data:"):
                continue
            self.events += 1
            image = json.loads(text[5:])["image"]
            begun = time.monotonic()
            if image and begun >= self.next_picture:
                self.pictures += 1
                self.bytes += len(self.daemon_.get(image["png"])[1])
                took = time.monotonic() - begun
                self.next_picture = begun + min(3.0, max(0.2, 5 * took))


def submit(daemon, programs, options):
    command = [str(programs / "raykiln"), "submit", str(ROOT / "server/app/demo"), "--server",
               daemon.url, "--size", options.size, "--samples", str(options.samples), "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"submit failed: {done.stderr}")
    return done.stdout.strip()


def one_run(daemon, programs, options):
    before, cpu_before = daemon.tasks(), daemon.cpu_seconds()
    job = submit(daemon, programs, options)
    watcher = None if options.no_watcher else Watcher(daemon, job)
    while (seen := daemon.json(f"/v1/jobs/{job}"))["state"] not in ("completed", "failed", "cancelled"):
        time.sleep(0.5)
    if seen["state"] != "completed":
        raise SystemExit(f"the job ended as {seen['state']}: {seen['error']}")
    if watcher:
        watcher.join(30)
    s, after = seen["statistics"], daemon.tasks()
    cpu = {name: now - cpu_before[name] for name, now in daemon.cpu_seconds().items()}
    count = after[1] - before[1]
    spent = s["worker_seconds"]
    shares = {f"{name}_share": s[f"{name}_seconds"] / spent for name in ("idle", "merge", "publish")}
    whole = options.workers * s["render_seconds"]
    return {
        "overhead_fraction": s["overhead_fraction"], **shares,
        "share_not_rendering": (whole - spent) / spent,
        "mean_task_seconds": (after[0] - before[0]) / count, "tasks": count,
        "share_of_tasks_up_to_seconds": {
            str(le): round((n - before[2][le]) / count, 4) for le, n in after[2].items()},
        "worker_seconds": spent, "render_seconds": s["render_seconds"],
        "cpu_per_worker_second": cpu["render"] / spent,
        "scheduler_cpu_share": cpu["scheduler"] / cpu["render"],
        "http_and_disk_cpu_share": cpu["others"] / cpu["render"],
        "rays_per_second": s["rays_per_second"],
        "events_seen": watcher.events if watcher else 0,
        "pictures_fetched": watcher.pictures if watcher else 0,
    }


def parse():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--bin", default=str(ROOT / "build/test/bin"), help="where the programs are")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--size", default="640x480")
    parser.add_argument("--samples", type=int, default=32)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--no-watcher", action="store_true")
    parser.add_argument("--json", metavar="FILE", help="write the result there too")
    return parser.parse_args()


def main():
    options = parse()
    programs = Path(options.bin)
    daemon = Daemon(programs, options.workers)
    try:
        runs = [one_run(daemon, programs, options) for _ in range(options.runs)]
    finally:
        daemon.stop()
    overhead = statistics.median(run["overhead_fraction"] for run in runs)
    result = {"benchmark": "bench_daemon_overhead", "scene": "server/app/demo", "size": options.size,
              "samples": options.samples, "workers": options.workers,
              "watched": not options.no_watcher, "load_average": os.getloadavg()[0],
              "promise": PROMISE, "median_overhead_fraction": overhead,
              "kept": overhead < PROMISE, "runs": runs}
    text = json.dumps(result, indent=1)
    print(text)
    if options.json:
        Path(options.json).write_text(text + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
