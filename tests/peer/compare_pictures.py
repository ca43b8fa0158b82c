#!/usr/bin/env python3
"""Renders the same scenes by raykiln and by Mitsuba 3, and tells whether the pictures differ by more
than their noise explains. Started by tests/peer/run, in whose environment Mitsuba lives.

The last line is "N passed, N failed". A row that raykiln refuses, or of which it says that it leaves
something out, is listed as missing and is neither.
"""

import argparse
import json
import os
import shutil
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

import mitsuba as mi
import numpy as np

import scenes
import statistics_r5
from our_renders import Missing, Raykiln

ROOT = Path(__file__).resolve().parents[2]
WORK = ROOT / "build" / "peer"
RENDERS = 8  # of each program, unless --renders says otherwise
OUR_SEED, THEIR_SEED, CHECK_SEED = 1, 101, 201
TABLE = ("<!-- table -->", "<!-- end of table -->")


@dataclass
class Row:
    name: str
    title: str
    write: object
    options: dict = field(default_factory=dict)  # of raykiln's job
    facets: str = "stock"      # stock: Mitsuba's own; gltf: gltf_facets.py; check: that against its own
    judged: bool = True
    pixel_tolerance: float = 0.0  # share of a pixel that the conversion of the scene costs
    roulette_from: int = 5     # bounces before Mitsuba's, which ends 5 % of the paths even where nothing is lost
    samples: int = 48          # of a pixel in each render
    size: tuple = (64, 64)


ROWS = [
    Row("cornell", "Cornell box", scenes.cornell),
    Row("cornell_sobol", "the same by Sobol' points", scenes.cornell, {"sampler": "sobol"}),
    Row("glass_mirror", "glass and mirror spheres in a box", scenes.glass_and_mirror),
    *(Row(f"metal_{r}", f"metal, roughness {r}", scenes.metal(r), facets="gltf") for r in (0.1, 0.3, 0.6, 1.0)),
    Row("metal_check", "Mitsuba's plug-in against its `principled`, roughness 0.6", scenes.metal(0.6), facets="check"),
    Row("metal_stock", "not judged: metal, roughness 0.6, against `principled`", scenes.metal(0.6), judged=False),
    Row("plastic", "diffuse base below facets, roughness 0.4", scenes.plastic, facets="gltf"),
    # Light that enters at the rim of a ball stays for hundreds of bounces: by such a roulette a few pixels hold it, with
    # weights of 1 / 0.95^n, and the rest are too dark.
    Row("glass_smooth", "body of glass", scenes.glass_body(0), roulette_from=1000),
    Row("glass_absorbing", "absorbing body of glass", scenes.glass_body(0, [0.9, 0.4, 0.2])),
    Row("glass_rough", "rough glass, roughness 0.4", scenes.glass_body(0.4), facets="gltf"),
    Row("glass_check", "Mitsuba's plug-in against its `roughdielectric`", scenes.glass_body(0.4), facets="check"),
    Row("textured", "textured glTF: colour and emission, turned and scaled", scenes.textured),
    # Mitsuba blends across the borders of the repeated texels: up to 0.15 % where a border crosses a pixel.
    Row("environment", "environment light", scenes.environment, pixel_tolerance=0.002),
    Row("emitters", "1000 emitters", scenes.many_emitters),
    Row("punctual", "point and directional light", scenes.punctual),
    # Mitsuba lights what is behind the veil by chance hits alone: with few samples no mean of 8 is normal.
    Row("half_covered", "a body that covers 0.4", scenes.half_covered, samples=256),
    Row("foliage", "alpha-masked foliage", scenes.foliage),
    Row("thin_lens", "thin lens", scenes.thin_lens),
]


def ours(row, folder, daemon, renders) -> np.ndarray:
    scene, pictures = daemon.upload(folder), []
    for k in range(renders):
        picture = daemon.render(scene, row.size, row.samples, OUR_SEED + k, **row.options)
        (folder / "ours.exr").write_bytes(picture)
        pictures.append(np.array(mi.Bitmap(str(folder / "ours.exr")))[..., :3].astype(float))
    (folder / "ours.exr").unlink()
    return np.array(pictures)


def theirs(row, folder, variant, facets, first_seed, renders) -> np.ndarray:
    mi.set_variant(variant)
    if variant != "scalar_rgb":
        import gltf_facets
        gltf_facets.register()  # its classes derive from those of the variant that is set
    scratch = folder / "mitsuba"
    scratch.mkdir(exist_ok=True)
    if (folder / "scene.obj").exists():
        import mitsuba_from_obj
        description = mitsuba_from_obj.convert(folder, scratch, row.size)
    else:
        import mitsuba_from_gltf
        description = mitsuba_from_gltf.convert(folder, scratch, row.size, facets)
    description["integrator"]["rr_depth"] = row.roulette_from
    scene = mi.load_dict(description)
    return np.array([np.array(mi.render(scene, spp=row.samples, seed=first_seed + k)).astype(float)
                     for k in range(renders)])


def pair(row, folder, daemon, renders):
    import stock_facets
    if row.facets == "stock":
        return (ours(row, folder, daemon, renders),
                theirs(row, folder, "scalar_rgb", stock_facets, THEIR_SEED, renders))
    if not os.environ.get("DRJIT_LIBLLVM_PATH"):
        raise Missing("not tried: a plug-in in Python wants LLVM (Debian: libllvm19)")
    mi.set_variant("llvm_ad_rgb")
    from gltf_facets import Look
    if row.facets == "check":
        return (theirs(row, folder, "llvm_ad_rgb", Look(separable=True, single=True), CHECK_SEED, renders),
                theirs(row, folder, "llvm_ad_rgb", stock_facets, THEIR_SEED, renders))
    return (ours(row, folder, daemon, renders),
            theirs(row, folder, "llvm_ad_rgb", Look(), THEIR_SEED, renders))


def judge(row, daemon, renders) -> dict:
    start, folder = time.monotonic(), WORK / row.name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    mi.set_variant("scalar_rgb")
    result = {"name": row.name, "title": row.title, "judged": row.judged}
    row.write(folder)
    try:
        verdict = statistics_r5.compare(*pair(row, folder, daemon, renders), row.pixel_tolerance)
    except Missing as missing:
        return result | {"missing": str(missing), "seconds": time.monotonic() - start}
    worst = int(np.argmax(np.abs(verdict.difference / verdict.sigma)))
    return result | {
        "passed": verdict.passes(), "accepted": verdict.accepted, "block": verdict.worst_block,
        "block_limit": verdict.block_limit, "mean_z": float(verdict.mean_z[worst]),
        "difference": float(verdict.difference[worst]), "sigma": float(verdict.sigma[worst]),
        "seconds": time.monotonic() - start}


def line(result) -> str:
    if "missing" in result:
        return f"| {result['title']} | | | | | missing; {result['missing']} |"
    word = "equal" if result["passed"] else "DIFFERENT"
    word = word if result["judged"] else "differs as it must"
    return (f"| {result['title']} | {100 * result['accepted']:.2f} | {result['mean_z']:+.2f} | "
            f"{100 * result['difference']:+.2f} +- {100 * result['sigma']:.2f} | "
            f"{result['block']:.1f} | {word} |")


def table(results, renders_of) -> str:
    head = ["| scene | pixels alike, % | z of the mean | difference of the mean, % | largest z of a block | verdict |",
            "|---|---|---|---|---|---|"]
    limit = next((r["block_limit"] for r in results if "block_limit" in r), 0.0)
    return "\n".join([*head, *map(line, results), "", f"{renders_of} Blocks: chance alone stays below {limit:.1f}."])


def write_readme(text):
    path = Path(__file__).with_name("README.md")
    before, rest = path.read_text().split(TABLE[0])
    path.write_text(before + TABLE[0] + "\n" + text + "\n" + TABLE[1] + rest.split(TABLE[1])[1])


def parse():
    parser = argparse.ArgumentParser(prog="tests/peer/run", description="raykiln and Mitsuba 3 on the same scenes")
    parser.add_argument("--only", action="append", default=[], help="row, by name (may be given again)")
    parser.add_argument("--bin", default=os.environ.get("RAYKILN_BIN_DIR", str(ROOT / "build/test/bin")))
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--renders", type=int, default=RENDERS, help="of each program, 3 at least")
    parser.add_argument("--samples", type=int, help="of a pixel in each render")
    parser.add_argument("--readme", action="store_true", help="put the table into README.md")
    return parser.parse_args()


def main() -> int:
    options, results = parse(), []
    record = WORK / "pictures.json"
    known = json.loads(record.read_text()) if options.only and record.exists() else {}
    with Raykiln(WORK / "daemon", Path(options.bin), options.threads) as daemon:
        for row in ROWS:
            if options.only and row.name not in options.only:
                continue
            row.samples = options.samples or row.samples
            results.append(judge(row, daemon, options.renders))
            print(f"{line(results[-1])} {results[-1]['seconds']:.0f} s", flush=True)
            known[row.name] = results[-1]
            record.write_text(json.dumps(known, indent=1, default=float))
    if options.readme:
        write_readme(table([known[row.name] for row in ROWS if row.name in known],
                           f"Mitsuba {mi.__version__}; {options.renders} renders of independent seeds a program, "
                           f"{options.samples or ROWS[0].samples} samples of 64 x 64 pixels each."))
    judged = [r for r in results if r["judged"] and "missing" not in r]
    passed = sum(r["passed"] for r in judged)
    print(f"{sum('missing' in r for r in results)} missing")
    print(f"{passed} passed, {len(judged) - passed} failed")
    return 0 if judged and passed == len(judged) else 1


if __name__ == "__main__":
    sys.exit(main())
