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
was measured. Status: *holds*; **falls short** marks a promise that is not kept yet, whose test holds
today's figure; *due with accuracy* are promises about shown error figures, notices of missing light
and forecasts. "0 of n" bounds a rate by 3/n at 95 %. Time is processor time. Mode is the light model:
*any* where none enters. This file is generated:

    rm -f build/hard.jsonl
    RAYKILN_HARD_REPORT=$PWD/build/hard.jsonl ctest --test-dir build/test -L hard
    tests/hard/make_table.py build/hard.jsonl

`RAYKILN_LONG=1` before `ctest` takes 1e7 trials per "never" claim, 1e8 for V03, V04 and V13;
`tests/run --full` does that.
Groups: K building the kd-tree, V walking it and meeting triangles, S shading, D dielectrics, L light
and sampling, M measured error, F film, X invariance, T scenes with a closed-form answer.
"""

GROUPS = "KVSDLMFXT"

# Entry, what of it, promise.
DUE = []  # none is left


def read(path):
    rows = [json.loads(line) for line in Path(path).read_text().splitlines() if line.strip()]
    latest = {row["test"] + "|" + row["input"]: row for row in rows}  # a repeated test counts once
    return list(latest.values())


def order(entry):
    group = GROUPS.find(entry[0])
    return (group if group >= 0 else len(GROUPS), entry)


def status(row):
    if not row["passed"]:
        return "**FAILED**"
    return "**falls short**" if row["falls_short"] else "holds"


def line(cells):
    return "| " + " | ".join(str(cell).strip().replace("|", "\\|") for cell in cells) + " |"


def table(rows):
    cells = [(order(row["id"]), 0, row["test"], row["input"],
              (row["id"], row["input"], row["promise"], row["measured"], f"{row['seconds']:.1f}", row["mode"],
               status(row))) for row in rows]
    cells += [(order(entry), 1, what, "", (entry, what, promise, "", "", "", "due with accuracy"))
              for entry, what, promise in DUE]
    head = line(["id", "input", "promise", "measured", "time, s", "mode", "status"])
    return "\n".join(["", head, "|---" * 7 + "|", *(line(row[-1]) for row in sorted(cells))]) + "\n"


def summary(rows):
    entries = {row["id"] for row in rows}
    failed = sum(not row["passed"] for row in rows)
    short = sum(row["falls_short"] for row in rows)
    run = "long run" if rows and all(row["long"] for row in rows) else "usual run"
    seconds = sum(row["seconds"] for row in rows)
    return (f"\n{len(entries)} entries, {len(rows)} rows, {failed} failed, {short} falling short, "
            f"{len(DUE)} due with accuracy; {run}, {seconds:.0f} s of one processor.\n")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    rows = read(sys.argv[1])
    if not rows:
        sys.exit("no rows: was RAYKILN_HARD_REPORT set when the tests ran?")
    Path(__file__).with_name("README.md").write_text(HEADER + summary(rows) + table(rows))


if __name__ == "__main__":
    main()
