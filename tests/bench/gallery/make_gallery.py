#!/usr/bin/env python3
"""Renders the pictures of the gallery and prints its table.

    tests/bench/gallery/make_gallery.py [--raykiln build/test/bin/raykiln] [--only NAME]

Writes the scenes to build/gallery, the pictures beside this file, and the table into the project's README.md.
"""

import argparse
import pathlib
import re
import subprocess
import sys

from scenes import SCENES

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
OUT = ROOT / "build" / "gallery"
README = ROOT / "README.md"
BEGIN, END = "<!-- gallery -->", "<!-- /gallery -->"

# What is rendered, and with which words beside `raykiln render SCENE -o NAME.png`.
PICTURES = {
    "box": ("server/app/demo", "--size 400x400 --samples 128"),
    "metals": ("build/gallery/metals", "--size 560x350 --samples 128 --sampler sobol"),
    "street": ("build/gallery/street", "--size 560x350 --samples 128"),
    "glasses": ("build/gallery/glasses", "--size 560x350 --samples 256"),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--raykiln", default=str(ROOT / "build" / "test" / "bin" / "raykiln"))
    parser.add_argument("--only", choices=PICTURES, action="append")
    options = parser.parse_args()
    OUT.mkdir(parents=True, exist_ok=True)
    rows = known_rows()
    for name, (scene, words) in PICTURES.items():
        if options.only and name not in options.only:
            continue
        if name in SCENES:
            (OUT / name).mkdir(exist_ok=True)
            SCENES[name](OUT / name)
        rows[name] = render(options.raykiln, name, scene, words)
        print(rows[name], flush=True)
    write_table(rows)


def render(program, name, scene, words):
    picture = HERE / f"{name}.png"
    done = subprocess.run([program, "render", scene, *words.split(), "-o", str(picture), "-o", str(OUT / f"{name}.exr")],
                          cwd=ROOT, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{name}: exit code {done.returncode}\n{done.stderr}")
    return figures(name, scene, words, done.stderr + done.stdout)


def figures(name, scene, words, log):
    """A row of the table, from what `raykiln render` says when it is done."""
    seconds = re.findall(r"100 %.*?([\d.]+) s,", log)
    error = re.search(r"error ([\d.]+) % \(95 %: ([\d.]+) % to ([\d.]+) %\) after (\d+) samples", log)
    if not seconds or not error:
        sys.exit(f"{name}: no figures in\n{log}")
    return (f"| ![{name}]({HERE.relative_to(ROOT)}/{name}.png) | `raykiln render {scene} {words} -o {name}.png` | {seconds[-1]} | {error[4]} | "
            f"{error[1]} % ({error[2]} to {error[3]}) |")


def known_rows():
    """The rows that the README has, by name: those that are not rendered now stay."""
    text = README.read_text()
    rows = text[text.index(BEGIN):text.index(END)].splitlines()
    return dict((row[4:row.index("]")], row) for row in rows if row.startswith("| !["))


def write_table(rows):
    text = README.read_text()
    head, tail = text[:text.index(BEGIN)], text[text.index(END):]
    table = ["| picture | command | s | samples | error, 95 % |", "|---|---|---|---|---|"]
    table += [rows[name] for name in PICTURES if name in rows]
    README.write_text(head + BEGIN + "\n" + "\n".join(table) + "\n" + tail)


if __name__ == "__main__":
    main()
