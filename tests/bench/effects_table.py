#!/usr/bin/env python3
"""The table of what leaving effects out saves: times by bench_effects, instructions by callgrind.

usage: tests/bench/effects_table.py [PROGRAM]    (build/test/bin/bench_effects)

Instructions are those of render_tile alone, divided by all rays of the render; they do not depend on
how busy the machine is. Without valgrind that column is left empty.
"""

import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SIDE, SAMPLES = "32", "8"


def instructions_per_ray(program: str, scene: str, mode: str) -> float:
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run(
            ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/out",
             "--toggle-collect=raykiln::render::render_tile*", program, SIDE, SAMPLES, scene, mode],
            capture_output=True, text=True, check=True)
    instructions = int(re.search(r"Collected\s*:\s*(\d+)", run.stderr).group(1))
    return instructions / int(run.stdout)


def main() -> int:
    program = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "build/test/bin/bench_effects")
    timed = subprocess.run([program], capture_output=True, text=True, check=False)
    if timed.returncode != 0:
        print(timed.stdout + timed.stderr, file=sys.stderr)
        return timed.returncode
    print("| scene | s, all | s, auto | ratio | instructions a ray, all | auto | ratio |")
    print("|---|---|---|---|---|---|---|")
    for row in json.loads(timed.stdout)["scenes"]:
        counted = " | | "
        if shutil.which("valgrind"):
            general, lean = (instructions_per_ray(program, row["scene"], mode) for mode in ("all", "auto"))
            counted = f"{general:.0f} | {lean:.0f} | {general / lean:.2f}"
        print(f"| `{row['scene']}` | {row['all_seconds']:.3f} | {row['auto_seconds']:.3f} | "
              f"{row['ratio']:.2f} | {counted} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
