#!/usr/bin/python3
"""What it costs to judge a picture's error while it is rendered, and to show it.

The same watched job runs in turn on two daemons: one as it comes, one with `--look-share 0`, which
judges the error of a picture once, in the end. Prints JSON: seconds of every run, the ratio of
each pair and the median of the ratios, meant to stay below 1.02; `accuracy_seconds` is what
the first says that it spent on looks, over the seconds of its workers.

    tests/bench/server/bench_recording_cost.py [--bin build/release/bin] [--pairs 5]

Processor seconds of the whole daemon wander less than wall seconds; both are given.
"""

import argparse
import json
import os
import statistics
import sys
import time
from pathlib import Path

from bench_daemon_overhead import ROOT, Daemon, Watcher, submit

PROMISE = 1.02


def one_run(daemon, programs, options):
    before = sum(daemon.cpu_seconds().values())
    job = submit(daemon, programs, options)
    watcher = Watcher(daemon, job)
    while (seen := daemon.json(f"/v1/jobs/{job}"))["state"] not in ("completed", "failed", "cancelled"):
        time.sleep(0.2)
    if seen["state"] != "completed":
        raise SystemExit(f"the job ended as {seen['state']}: {seen['error']}")
    watcher.join(30)
    curve = daemon.json(f"/v1/jobs/{job}/accuracy")
    s = seen["statistics"]
    return {"render_seconds": s["render_seconds"],
            "cpu_seconds": sum(daemon.cpu_seconds().values()) - before,
            "looks": len(curve["points"]), "accuracy_seconds": s["accuracy_seconds"],
            "looks_share": s["accuracy_seconds"] / s["worker_seconds"]}


def ratios(pairs, what):
    each = [on[what] / off[what] for on, off in pairs]
    return {"each": each, "median": statistics.median(each)}


def parse():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--bin", default=str(ROOT / "build/test/bin"), help="where the programs are")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--size", default="640x480")
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--json", metavar="FILE", help="write the result there too")
    return parser.parse_args()


def main():
    options = parse()
    programs = Path(options.bin)
    daemons = [Daemon(programs, options.workers), Daemon(programs, options.workers, "--look-share", "0")]
    pairs = []
    try:
        for daemon in daemons:  # trees are built, pages touched
            one_run(daemon, programs, argparse.Namespace(**{**vars(options), "samples": 2}))
        for _ in range(options.pairs):
            pairs.append([one_run(daemon, programs, options) for daemon in daemons])
    finally:
        for daemon in daemons:
            daemon.stop()
    wall = ratios(pairs, "render_seconds")
    result = {"benchmark": "bench_recording_cost", "size": options.size, "samples": options.samples,
              "workers": options.workers, "load_average": os.getloadavg()[0], "promise": PROMISE,
              "wall": wall, "cpu": ratios(pairs, "cpu_seconds"), "kept": wall["median"] < PROMISE,
              "pairs": [{"with": on, "without": off} for on, off in pairs]}
    text = json.dumps(result, indent=1)
    print(text)
    if options.json:
        Path(options.json).write_text(text + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
