#!/usr/bin/env python3
"""The tables of noise at equal time in tests/bench/README.md, by bench_sampler and bench_many_lights.

usage: tests/bench/noise_tables.py [samplers] [lights] [--readme] [--bin DIR]

Seconds are the processor's, of renders in turns. `--readme` puts the tables into the README.
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
README = Path(__file__).with_name("README.md")
COMMANDS = {"samplers": ["bench_sampler", "12", "1024", "32"], "lights": ["bench_many_lights", "16", "24", "32"]}
AT = ("16", "128", "1024")
TITLES = {
    "box_under_lamp": "box under a lamp, open ground",
    "diffuse_with_area_light": "room with a lamp in its ceiling",
    "glass_with_caustic": "glass with a caustic",
    "room_1": "closed room, 1 lamp in the ceiling", "room_4": "4 lamps", "room_8": "8 lamps",
    "hall_10m_1": "hall of 10 m, 1 lamp", "hall_10m_2": "2 lamps", "hall_10m_4": "4 lamps",
    "hall_10m_8": "8 lamps", "hall_10m_16": "16 lamps", "hall_10m_500": "500 lamps",
    "hall_10m_50000": "50000 lamps", "hall_100m_500": "hall of 100 m, 500 lamps",
    "hall_100m_50000": "50000 lamps",
    "sparks_between_panels": "500 sparks of 0.3 mm between walls of dim light",
    "glowing_ball": "a ball of light",
}


def measured(kind: str, folder: Path) -> list:
    name, *arguments = COMMANDS[kind]
    run = subprocess.run([str(folder / name), *arguments], capture_output=True, text=True, check=True)
    return [row for row in json.loads(run.stdout)["scenes"] if row]


def samplers(rows) -> list:
    lines = ["| scene | slope, random | Sobol' | relMSE at 16, random : Sobol' | at 128 | at 1024 | seconds, Sobol' : random "
             "| gain at equal time, at 16 | at 128 | at 1024 |", "|" + "---|" * 10]
    for row in rows:
        a, b = row["random"], row["sobol"]
        ratios = [f"{a['rel_mse'][n] / b['rel_mse'][n]:.2f}" for n in AT]
        gains = [f"{row['gain_at_equal_time'][n]:.2f}" for n in AT]
        lines.append(f"| {TITLES[row['scene']]} | {a['slope']:.2f} | {b['slope']:.2f} | {' | '.join(ratios)} | "
                     f"{row['seconds_sobol_over_random']:.2f} | {' | '.join(gains)} |")
    return lines


def lights(rows) -> list:
    lines = ["| scene | emitting triangles | relMSE, by power | from the tree | seconds, tree : power "
             "| gain at equal samples | gain at equal time |", "|" + "---|" * 7]
    for row in rows:
        lines.append(f"| {TITLES[row['scene']]} | {row['emitting_triangles']} | {row['rel_mse_power']:.3f} | "
                     f"{row['rel_mse_tree']:.3f} | {row['seconds_tree'] / row['seconds_power']:.2f} | "
                     f"{row['gain_at_equal_samples']:.2f} | {row['gain_at_equal_time']:.2f} |")
    return lines


def put(kind: str, lines):
    head, rest = README.read_text().split(f"<!-- {kind} -->\n")
    tail = rest.split(f"<!-- /{kind} -->")[1]
    README.write_text(head + "\n".join([f"<!-- {kind} -->", *lines, f"<!-- /{kind} -->"]) + tail)


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests/bench/noise_tables.py", description="noise at equal time")
    parser.add_argument("tables", nargs="*", help="samplers, lights; both if none is named")
    parser.add_argument("--readme", action="store_true")
    parser.add_argument("--bin", type=Path, default=ROOT / "build/test/bin")
    options = parser.parse_args()
    for kind in options.tables or COMMANDS:
        lines = {"samplers": samplers, "lights": lights}[kind](measured(kind, options.bin))
        print("\n".join([f"{' '.join(COMMANDS[kind])}:", *lines, ""]), flush=True)
        if options.readme:
            put(kind, lines)
    return 0


if __name__ == "__main__":
    sys.exit(main())
