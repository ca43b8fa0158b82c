#!/usr/bin/env python3
"""Seconds to equal error, raykiln and Mitsuba 3 (`llvm_ad_rgb`) on the same scenes and the same threads.

relMSE = mean over pixels and channels of (x - r)^2 / (r^2 + 0.01 mean(r)^2). It is taken from pairs: renders
of one method with independent seeds differ by twice their error, with no noise of a reference in it; r, in the
denominator, is the mean of all renders of both programs. tests/peer shows that both have the same r.

Error of stratified samples falls faster than 1/n, and not evenly, so each method is measured on both sides of the target: a
first pair of renders tells where it is, and the powers of 2 next to it, of 16 to --most, are rendered in all turns. Seconds to the
target lie on the straight line through both of log(seconds) over log(relMSE); fewer samples than 16 lie on that through 16 and 32.
Where --most is not enough it is the one count, and from t seconds with error e, e t / target seconds give the target, as by 1/n.

Methods take turns, so that a loud machine is loud for all. Seconds are of processor time, of all threads, of
rendering alone: for raykiln what n samples take beyond one sample, by a render of --timed samples if n is less (what
the build of a large tree takes differs from call to call by as much as 16 samples take); for Mitsuba of a warm call,
compiled before.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests" / "peer"))

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

import mitsuba_from_obj
from speed_scenes import SCENES

WORK = ROOT / "build" / "peers"
BEGIN, END = "<!-- table -->", "<!-- end of table -->"
TARGET = 0.003


def children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def own() -> float:
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


class Raykiln:
    def __init__(self, program, folder, side, threads, sampler, timed):
        self.name, self.folder, self.target = f"raykiln {sampler}", folder, WORK / f"{sampler}.exr"
        self.command = [program, "-q", "render", "--json", str(folder), "-o", str(self.target), "--size",
                        f"{side}x{side}", "--threads", str(threads), "--sampler", sampler]
        self.start, self.timed = None, timed

    def call(self, samples, seed):
        before = children()
        done = subprocess.run([*self.command, "--samples", str(samples), "--seed", str(seed)], check=True,
                              capture_output=True, text=True)
        self.statistics = json.loads(done.stdout)["statistics"]
        picture = np.array(mi.Bitmap(str(self.target)))[..., :3].astype(float)
        return picture, children() - before, self.statistics["render_seconds"]

    def warm(self, samples):
        del samples
        self.start = min(self.call(1, seed)[1] for seed in (1, 2))

    def render(self, samples, seed):
        picture, cpu, wall = self.call(samples, seed)
        timed = max(samples, self.timed)
        if timed > samples:
            cpu = self.call(timed, seed)[1]
        return picture, (cpu - self.start) * samples / (timed - 1), wall


class Mitsuba:
    def __init__(self, folder, side, sampler):
        self.name = f"Mitsuba {sampler}"
        scratch = folder / "mitsuba"
        scratch.mkdir(exist_ok=True)
        description = mitsuba_from_obj.convert(folder, scratch, (side, side))
        description["sensor"]["sampler"] = {"type": sampler}
        self.scene = mi.load_dict(description)

    def warm(self, samples):
        self.render(samples, 99)

    def render(self, samples, seed):
        before, clock = own(), time.monotonic()
        picture = mi.render(self.scene, spp=samples, seed=seed)
        dr.eval(picture)
        dr.sync_thread()
        wall, cpu = time.monotonic() - clock, own() - before
        return np.array(picture).astype(float), cpu, wall


def counts_beside(wanted, most) -> list:
    """The powers of 2 on either side of so many samples; the largest alone where it is not enough."""
    low = int(np.clip(np.floor(np.log2(wanted)), 4, np.log2(most)))
    return [n for n in (2**low, 2 ** (low + 1)) if n <= most]


def seconds_to_target(renders) -> float:
    """On the line through the first and the last; by 1/n where there is one, or where noise hides that errors fall."""
    first, last = renders[0], renders[-1]
    if not last["relmse"] < first["relmse"]:
        return last["cpu_s"] * last["relmse"] / TARGET
    slope = np.log(last["cpu_s"] / first["cpu_s"]) / np.log(first["relmse"] / last["relmse"])
    return float(first["cpu_s"] * (first["relmse"] / TARGET) ** slope)


def measure(name, options) -> dict:
    write, samples = SCENES[name]
    folder = WORK / name.split(",")[0].replace(" ", "_")
    folder.mkdir(parents=True, exist_ok=True)
    write(folder)
    program = str(Path(options.bin) / "raykiln")
    methods = [Raykiln(program, folder, options.side, options.threads, s, options.timed)
               for s in ("random", "sobol")]
    methods += [Mitsuba(folder, options.side, s) for s in ("independent", "multijitter")]
    counts = {}
    for method in methods:
        method.warm(samples)
        pilot = [method.render(samples, seed)[0] for seed in (3, 4)]
        r = np.mean(pilot, 0)
        error = float((np.var(pilot, axis=0, ddof=1) / (r**2 + 0.01 * r.mean() ** 2)).mean())
        counts[method.name] = counts_beside(samples * error / TARGET, options.most)
        for count in counts[method.name]:
            method.warm(count)
    found = {(m.name, n): {"pictures": [], "cpu": [], "wall": []} for m in methods for n in counts[m.name]}
    for turn in range(options.turns):
        for method in methods:
            for n in counts[method.name]:
                picture, seconds, clock = method.render(n, 10 + turn)
                into = found[method.name, n]
                into["pictures"].append(picture)
                into["cpu"].append(seconds)
                into["wall"].append(clock)
    r = np.mean([np.mean(part["pictures"], 0) for part in found.values()], 0)
    weight = 1 / (r**2 + 0.01 * r.mean() ** 2)
    result = {}
    for method in (m.name for m in methods):
        renders = [{"samples": n, "cpu_s": float(np.median(found[method, n]["cpu"])), "wall_s": float(np.median(found[method, n]["wall"])),
                    "relmse": float((np.var(found[method, n]["pictures"], axis=0, ddof=1) * weight).mean())}
                   for n in counts[method]]
        mean = np.mean([np.mean(found[method, n]["pictures"]) for n in counts[method]])
        result[method] = {"side": options.side, "renders": renders, "to_target_s": seconds_to_target(renders),
                          "bias": float(mean / r.mean() - 1)}
        print(f"{name} | {method}: {result[method]}", flush=True)
    return result


def cell(found) -> str:
    renders = "; ".join(f"{v['samples']}, {v['cpu_s']:.2f} s, {v['relmse']:.2g}" for v in found["renders"])
    return f"{found['to_target_s']:.2f} ({renders})"


def line(name, result) -> str:
    best = {who: min(v["to_target_s"] for k, v in result.items() if k.startswith(who))
            for who in ("raykiln", "Mitsuba")}
    return f"| {name} | {' | '.join(cell(v) for v in result.values())} | **{best['raykiln'] / best['Mitsuba']:.2f}** |"


def efficiency(options) -> list:
    """Seconds for a million samples of raykiln alone, at one thread and at two, and where one thread spends them."""
    lines = ["| scene | processor s a million samples, 1 thread | 2 threads | wall s, 1 thread | 2 threads | efficiency by wall | by processor time "
             "| traversal | shading | rest |", "|---|" + "---|" * 9]
    folders = {"demo": ROOT / "server/app/demo"} | {
        name: WORK / name.split(",")[0].replace(" ", "_") for name in SCENES if name in options.done}
    for name, folder in folders.items():
        found, shares = {}, []
        for threads in (1, 2, 1, 2):
            render = Raykiln(str(Path(options.bin) / "raykiln"), folder, options.side, threads, "random", 32)
            render.warm(1)
            _, cpu, wall = render.render(32, 5)
            if threads == 1:
                spent = render.statistics
                shares.append([spent[f"{part}_seconds"] / spent["worker_seconds"] for part in ("traversal", "shading")])
            scale = 1e6 / (32 * options.side**2)
            found.setdefault(threads, []).append((cpu * scale, wall * scale))
        (c1, w1), (c2, w2) = (np.min(found[t], 0) for t in (1, 2))
        walk, shade = np.mean(shares, 0)
        lines.append(f"| {name} | {c1:.2f} | {c2:.2f} | {w1:.2f} | {w2:.2f} | {w1 / (2 * w2):.2f} | {c1 / c2:.2f} "
                     f"| {walk:.0%} | {shade:.0%} | {1 - walk - shade:.0%} |")
        print(lines[-1], flush=True)
    return lines


def main():
    parser = argparse.ArgumentParser(prog="tests/bench/peers/run", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default=os.environ.get("RAYKILN_BIN_DIR", str(ROOT / "build/test/bin")))
    parser.add_argument("--only", action="append", default=[], help="a scene's name (may be given again)")
    parser.add_argument("--side", type=int, default=128, help="of the picture, pixels")
    parser.add_argument("--turns", type=int, default=3, help="at least 2: errors are taken from pairs")
    parser.add_argument("--most", type=int, default=256, help="samples a pixel of one render")
    parser.add_argument("--timed", type=int, default=256, help="samples of a render that is timed, at least")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--no-efficiency", action="store_true", help="leave the second table out")
    parser.add_argument("--readme", action="store_true", help="put the tables into README.md")
    options = parser.parse_args()
    if options.turns < 2:
        parser.error("--turns: at least 2")
    chosen = [n for n in SCENES if not options.only or n in options.only]
    options.done = chosen
    WORK.mkdir(parents=True, exist_ok=True)
    record = WORK / "speed.json"
    results = json.loads(record.read_text()) if options.only and record.exists() else {}
    for name in chosen:
        results[name] = measure(name, options)
        record.write_text(json.dumps(results, indent=1))
    results = {name: results[name] for name in SCENES if name in results}
    first = next(iter(results.values()))
    lines = [f"| scene | {' | '.join(first)} | raykiln / Mitsuba, better of each |", "|---" * (len(first) + 2) + "|"]
    lines += [line(name, result) for name, result in results.items()]
    lines += ["", f"Processor seconds to relMSE {TARGET} (in brackets: samples, seconds and relMSE of one render, on both sides); pictures of "
              f"{sorted({v['side'] for r in results.values() for v in r.values()})} pixels a side, {options.threads} threads, Mitsuba {mi.__version__}.", ""]
    lines += efficiency(options) if not options.no_efficiency else []
    print("\n".join(lines))
    if options.readme:
        path = Path(__file__).with_name("README.md")
        before, rest = path.read_text().split(BEGIN)
        path.write_text(before + BEGIN + "\n" + "\n".join(lines) + "\n" + END + rest.split(END)[1])


if __name__ == "__main__":
    main()
