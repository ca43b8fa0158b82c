#!/usr/bin/env python3
"""Turns the report of the hard cases into the table tests/hard/README.md.

    rm -f build/hard.jsonl
    RAYKILN_HARD_REPORT=$PWD/build/hard.jsonl ctest --test-dir build/test -L hard
    tests/hard/make_table.py build/hard.jsonl

With RAYKILN_LONG=1 before ctest the "never" claims get 1e7 trials, V03, V04 and V13 1e8.
"""

import json
import sys
from pathlib import Path

HEADER = """# Hard cases
Inputs on which renderers are known to break, and scenes whose answer is known in closed form; one
family of tests per entry, named by its id. A row is one test: what went in, what is promised, what
was measured. "Falls short" marks a promise that is not kept yet: its test holds today's figure. "0 of n" bounds a rate by 3/n at 95 %. Time is processor time. This file is generated:

    rm -f build/hard.jsonl
    RAYKILN_HARD_REPORT=$PWD/build/hard.jsonl ctest --test-dir build/test -L hard
    tests/hard/make_table.py build/hard.jsonl

`RAYKILN_LONG=1` before `ctest` takes 1e7 trials per "never" claim, 1e8 for V03, V04 and V13.
Groups: K building the kd-tree, V walking it and meeting triangles, S shading, D dielectrics, L light
and sampling, M measured error, F film, X invariance, T scenes with a closed-form answer.
"""

DUE = """
## Due with accuracy
Promises about shown error figures, notices of missing light and forecasts: not tested yet.

| entry | what is due |
|---|---|
"""

DUE_ROWS = [
    ("K10, last metric", "the predicted time of a scene that no split helps is within a factor 2"),
    ("L06", "an emitter that no path has hit is announced, with what may be missing"),
    ("L08", "the time that many lights take is predicted before the render"),
    ("M01", "no hit is not shown as no noise"),
    ("M02", "heavy tails are flagged beside the error bar"),
    ("M08, second line", "slopes of stratified and scrambled low-discrepancy samples"),
    ("M09", "the bias of stopping early is bounded"),
    ("M10", "one sample, no sample: the error is unknown, not 0"),
    ("R7", "coverage of the shown 95 % interval"),
    ("T02, report", "the reported truncation bias agrees within its own interval"),
]


def read(path):
    rows = [json.loads(line) for line in Path(path).read_text().splitlines() if line.strip()]
    latest = {row["test"] + "|" + row["input"]: row for row in rows}  # a repeated test counts once
    return sorted(latest.values(), key=lambda row: (row["id"], row["test"], row["input"]))


def cell(text):
    return str(text).replace("|", "\\|")


def table(rows):
    lines = ["", "| id | input | promise | measured | time, s | mode |", "|---|---|---|---|---|---|"]
    for row in rows:
        mark = "" if row["passed"] else " **FAILED**"
        if row["falls_short"]:
            mark += " **falls short**"
        lines.append("| {} | {} | {} | {}{} | {:.1f} | {} |".format(
            row["id"], cell(row["input"]), cell(row["promise"]), cell(row["measured"]), mark,
            row["seconds"], cell(row["mode"])))
    return "\n".join(lines) + "\n"


def summary(rows):
    entries = {row["id"] for row in rows}
    failed = sum(not row["passed"] for row in rows)
    short = sum(row["falls_short"] for row in rows)
    run = "long run" if rows and all(row["long"] for row in rows) else "usual run"
    seconds = sum(row["seconds"] for row in rows)
    return (f"\n{len(entries)} entries, {len(rows)} rows, {failed} failed, {short} falling short; {run}, "
            f"{seconds:.0f} s of one processor.\n")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    rows = read(sys.argv[1])
    if not rows:
        sys.exit("no rows: was RAYKILN_HARD_REPORT set when the tests ran?")
    due = "".join(f"| {entry} | {what} |\n" for entry, what in DUE_ROWS)
    text = HEADER + summary(rows) + table(rows) + DUE + due
    Path(__file__).with_name("README.md").write_text(text)


if __name__ == "__main__":
    main()
