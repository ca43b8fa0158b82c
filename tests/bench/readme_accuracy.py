#!/usr/bin/python3
"""Writes plots and tables of accuracy, each between its marks `<!-- accuracy:NAME -->` and `<!-- /accuracy:NAME -->`: `plots`, what knobs
cost; `targets`, whether error targets are kept; `adaptive`, what placing samples saves, all three in the README; and `bounds`, what it
can save at most, in renderer/accuracy/README.md.

    tests/bench/readme_accuracy.py [--bin build/test/bin] [--seconds 1] [--reference-seconds 60] [--only plots|targets|adaptive|bounds]

Knobs in three scenes: the demo, the demo with all its materials matte, and a box in the open under a point light and a sky. The rest in all
scenes of the README: the demo, the gallery, and those of the table of effects. A minute of a quiet machine for each second of --seconds; targets
take ten minutes, adaptive half an hour, bounds three minutes. --json FILE... takes what bench_adaptive has printed instead of running it.
"""

import argparse
import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests/e2e"), str(ROOT / "tests/bench/gallery")]
from scenes import SCENES  # noqa: E402
from support.scenes import box_files  # noqa: E402

PLOTS = ROOT / "renderer/study/plots"
STYLE = ("<style>text{font:12px sans-serif;fill:#777}.grid path{stroke:#8886;fill:none}"
         ".front{fill:none;stroke:#8886;stroke-width:9;stroke-linejoin:round}</style>")


def scenes(folder: Path) -> dict:
    """Name in the README to the folder of the scene."""
    demo = ROOT / "server/app/demo"
    matte, box = folder / "matte", folder / "box"
    matte.mkdir()
    shutil.copy(demo / "demo.obj", matte)
    sidecar = json.loads((demo / "raykiln.json").read_text())
    sidecar["materials"] = {}
    (matte / "raykiln.json").write_text(json.dumps(sidecar))
    materials = (demo / "demo.mtl").read_text()
    for name in ("glass", "mirror"):
        materials = re.sub(rf"(newmtl {name}\n).*?(?=\nnewmtl|\Z)", r"\1Kd 0.73 0.73 0.73\nillum 1\n", materials, flags=re.S)
    (matte / "demo.mtl").write_text(materials)
    box.mkdir()
    for name, content in box_files().items():
        (box / name).write_text(content) if isinstance(content, str) else (box / name).write_bytes(content)
    return {"demo": demo, "matte": matte, "box": box}


def study(options, folder: Path, scratch: Path) -> tuple:
    html = scratch / "report.html"
    run = subprocess.run([options.bin / "raykiln", "accuracy", folder, "--size", options.size, "--seconds", str(options.seconds),
                          "--reference-seconds", str(options.reference_seconds), "--json", "--quiet", "--html", html],
                         stdout=subprocess.PIPE, text=True, check=False)
    if run.returncode not in (0, 12):  # 12: the reference is not ten times as exact, which the table says
        raise SystemExit(f"raykiln accuracy {folder} ended with {run.returncode}")
    svg = re.search(r"<svg .*?</svg>", html.read_text(), flags=re.S).group(0)
    svg = svg.replace("<svg ", '<svg xmlns="http://www.w3.org/2000/svg" ', 1)
    return json.loads(run.stdout), svg.replace(">", f">{STYLE}", 1)


def ratio(value, base) -> str:
    return "not reached" if value is None or value < 0 or not base else f"{value / base:.2f}"


def bias(knob) -> str:
    found = knob["bias"]
    return f"**{100 * found['value']:.2g} %**" if found["certain"] else f"below {100 * found['at_most']:.2g} %"


def knob_table(reports: dict) -> str:
    names = []
    for report in reports.values():
        names += [knob["knob"] for knob in report["knobs"] if knob["knob"] not in names]
    lines = ["| knob | " + " | ".join(f"{name}: error, time, bias" for name in reports) + " |",
             "|---" * (1 + len(reports)) + "|"]
    for name in names:
        cells = []
        for report in reports.values():
            knob = next((k for k in report["knobs"] if k["knob"] == name), None)
            cells.append("-" if knob is None else
                         ", ".join([ratio(knob["error_at_equal_time"], report["equal_error"]),
                                    ratio(knob["seconds_to_equal_error"], report["equal_seconds"]), bias(knob)]))
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    told = "; ".join(f"{name}: {100 * r['equal_error']:.2g} % in {r['equal_seconds']:.2g} s, reference {100 * r['reference']['error']:.2g} %"
                     for name, r in reports.items())
    return "\n".join(lines) + f"\n\nDefaults: {told}.\n"


def plots(options) -> str:
    PLOTS.mkdir(exist_ok=True)
    reports = {}
    with tempfile.TemporaryDirectory() as scratch:
        for name, folder in scenes(Path(scratch)).items():
            reports[name], svg = study(options, folder, Path(scratch))
            (PLOTS / f"{name}.svg").write_text(svg + "\n")
    images = "\n".join(f"![Error against seconds, {name}](renderer/study/plots/{name}.svg)" for name in reports)
    return f"{images}\n\n{knob_table(reports)}"


def judged(options, *question: str) -> list:
    """What bench_adaptive says of the README's scenes; with the size of each."""
    if options.json:
        found = [json.loads(file.read_text()) for file in options.json]
    else:
        with tempfile.TemporaryDirectory() as scratch:
            made = []
            for name, write in SCENES.items():
                made.append(Path(scratch) / name)
                made[-1].mkdir()
                write(made[-1])
            run = subprocess.run([options.bin / "bench_adaptive", *question, ROOT / "server/app/demo", *made, "matte_point_light",
                                  "diffuse_cornell", "everything"], stdout=subprocess.PIPE, check=True)
        found = [json.loads(run.stdout)]
    return [row | {"size": f"{f['width']} x {f['height']}"} for f in found for row in f["scenes"]]


def targets(options) -> str:
    lines = ["| scene | pixels | target | samples | flagged | true error over the target | kept |", "|---|---|---|---|---|---|---|"]
    for row in judged(options, "--targets", options.target_size, str(options.seeds)):
        even = row["even"]
        lines.append(f"| {row['scene']} | {row['size']} | {100 * row['target']:.2g} % | {even['samples']:.0f} | "
                     f"{even['flagged']} of {row['seeds']} | {even['least']:.2f} to {even['largest']:.2f} | "
                     f"{even['kept']} of {row['seeds']} |")
    return "\n".join(lines) + "\n"


def adaptive(options) -> str:
    lines = ["| scene | pixels, seeds | target | samples, even | adaptive | time to equal error, even : adaptive | rays | by the plans | at most |",
             "|---" * 9 + "|"]
    for row in judged(options, options.adaptive_size, str(max(3, options.seeds // 4))):
        lines.append(f"| {row['scene']} | {row['size']}, {row['seeds']} | {100 * row['target']:.2g} % | {row['even']['samples']:.0f} | "
                     f"{row['adaptive']['samples']:.0f} | {row['gain']:.2f} | {row['gain_in_rays']:.2f} ({row['gain_low']:.2f} to "
                     f"{row['gain_high']:.2f}) | {row['gain_by_plan']:.2f} | {row['bound']:.2f} |")
    return "\n".join(lines) + "\n"


def bounds(options) -> str:
    lines = ["| scene | pixels | bound, in rays | blind to cost | left by the plan |", "|---|---|---|---|---|"]
    for row in judged(options, options.bounds_size, "0"):
        lines.append(f"| {row['scene']} | {row['size']} | {row['bound']:.2f} | {row['bound_in_samples']:.2f} | {row['left']:.2f} |")
    return "\n".join(lines) + "\n"


def put(text: str, name: str, content: str) -> str:
    begin, end = f"<!-- accuracy:{name} -->", f"<!-- /accuracy:{name} -->"
    before, rest = text.split(begin, 1)
    return f"{before}{begin}\n{content}{end}{rest.split(end, 1)[1]}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--bin", type=Path, default=ROOT / "build/test/bin", help="where the programs are")
    parser.add_argument("--size", default="96x72")
    parser.add_argument("--seconds", type=float, default=1.0, help="of one processor, for each knob")
    parser.add_argument("--reference-seconds", type=float, default=60.0)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--only", choices=("plots", "targets", "adaptive", "bounds"))
    parser.add_argument("--json", type=Path, nargs="+", default=[], help="what bench_adaptive has printed; with --only")
    parser.add_argument("--target-size", default="32x32")
    parser.add_argument("--adaptive-size", default="192x120")
    parser.add_argument("--bounds-size", default="160x100")
    options = parser.parse_args()
    readme, module = ROOT / "README.md", ROOT / "renderer/accuracy/README.md"
    for name, make, file in (("plots", plots, readme), ("targets", targets, readme), ("adaptive", adaptive, readme), ("bounds", bounds, module)):
        if options.only in (None, name):
            content = make(options)  # before the file is read: it may take long
            file.write_text(put(file.read_text(), name, content))


if __name__ == "__main__":
    main()
