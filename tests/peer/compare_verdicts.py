#!/usr/bin/env python3
"""Which glTF files are broken: raykiln's verdict beside that of the Khronos validator. Over models of
others (Debian's assimp-testmodels, glTF that npm packages ship) and files broken in one place each.

Where the two differ there must be a reason below; a difference without one is a failure.
Started by tests/peer/run. The last line is "N passed, N failed".
"""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

import broken_files
from our_renders import Raykiln

ROOT = Path(__file__).resolve().parents[2]
WORK = ROOT / "build" / "peer"
MODELS = Path("/usr/share/assimp/models")
BEGIN, END = "<!-- verdicts -->", "<!-- end of verdicts -->"

# Errors of the validator in files that raykiln takes, and why that is right.
FORGIVEN = {
    "ACCESSOR_MIN_MISMATCH": "bounds are computed, not read",
    "ACCESSOR_MAX_MISMATCH": "bounds are computed, not read",
    "ACCESSOR_ELEMENT_OUT_OF_MAX_BOUND": "bounds are computed, not read",
    "ACCESSOR_ELEMENT_OUT_OF_MIN_BOUND": "bounds are computed, not read",
    "MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS": "bounds are computed, not read",
    "ACCESSOR_VECTOR3_NON_UNIT": "normals are scaled to unit length",
    "MESH_PRIMITIVE_NO_TANGENT_SPACE": "a normal map's frame comes from its coordinates",
    "MESH_PRIMITIVE_INDEXED_SEMANTIC_CONTINUITY": "unused sets of coordinates are not read",
    "MESH_PRIMITIVE_TOO_FEW_TEXCOORDS": "a texture without coordinates is left out, with a warning",
    "NODE_PARENT_OVERRIDE": "a node of two parents is drawn under both",
    "ROTATION_NON_UNIT": "rotations are scaled to unit length",
    "VALUE_NOT_IN_RANGE": "a colour above 1 is what raykiln lint is for",
}
# Files that raykiln takes although more than that is wrong with them.
FORGIVEN_FILES = {
    "glTF2/IncorrectVertexArrays/Cube.gltf": "the views that do not fit are read by nothing",
    "glTF2/wrongTypes/badString.gltf": "the text of a field that is not read is a number",
}
# Refusals of files that the validator finds whole: part of raykiln's words, and why.
REFUSED = {
    "[scene_empty]": "nothing to render",
    "[scene_unsupported]": "needs an extension that raykiln does not have",
    "there is no alpha mode": "the validator only warns of an unknown word",
}
KINDS = ("broken here", "of others")


def validate(files) -> dict:
    done = subprocess.run(["node", str(Path(__file__).with_name("validate.mjs")), str(WORK / "npm"),
                           *map(str, files)], check=True, capture_output=True, text=True)
    return {Path(k): v["errors"] for k, v in json.loads(done.stdout).items()}


def reason(name, errors, words):
    """Why the verdicts may differ; None where nothing says so."""
    if words:
        return next((why for part, why in REFUSED.items() if part in words), None)
    if name in FORGIVEN_FILES:
        return FORGIVEN_FILES[name]
    codes = {code for code, *_ in errors}
    return "; ".join(sorted({FORGIVEN[c] for c in codes})) if codes <= set(FORGIVEN) else None


def collect():
    """(kind, name, path)"""
    folder = WORK / "broken"
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in broken_files.files():
        path = folder / f"{name}.gltf"
        path.write_bytes(data)
        yield KINDS[0], name, path
    shipped = WORK / "npm" / "node_modules" / "@webxr-input-profiles" / "assets" / "dist" / "profiles"
    for root in (MODELS, shipped):
        for path in sorted(p for p in root.rglob("*") if p.suffix in (".gltf", ".glb")):
            yield KINDS[1], str(path.relative_to(root)), path


def summary(rows) -> str:
    lines = ["| files | number | both take | both refuse | taken, in spite of errors | refused, though whole | unexplained |",
             "|---|---|---|---|---|---|---|"]
    for kind in KINDS:
        of = [r for r in rows if r["kind"] == kind]
        count = lambda test: sum(bool(test(r)) for r in of)
        lines.append(f"| {kind} | {len(of)} | {count(lambda r: not r['errors'] and not r['ours'])} | "
                     f"{count(lambda r: r['errors'] and r['ours'])} | "
                     f"{count(lambda r: r['errors'] and not r['ours'] and r['why'])} | "
                     f"{count(lambda r: r['ours'] and not r['errors'] and r['why'])} | "
                     f"{count(lambda r: r['why'] is None)} |")
    reasons = {}
    for row in rows:
        if row["why"]:
            reasons.setdefault(row["why"], []).append(row["name"])
    lines += ["", "| why they differ | files |", "|---|---|"]
    for why, names in sorted(reasons.items()):
        lines.append(f"| {why} | {', '.join(f'`{n}`' for n in names[:3])}{f' and {len(names) - 3} more' if len(names) > 3 else ''} |")
    return "\n".join(lines)


def write_readme(text):
    path = Path(__file__).with_name("README.md")
    before, rest = path.read_text().split(BEGIN)
    path.write_text(before + BEGIN + "\n" + text + "\n" + END + rest.split(END)[1])


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", default=os.environ.get("RAYKILN_BIN_DIR", str(ROOT / "build/test/bin")))
    parser.add_argument("--readme", action="store_true", help="put the tables into README.md")
    options, _ = parser.parse_known_args()
    files = list(collect())
    theirs, rows = validate([path for *_, path in files]), []
    with Raykiln(WORK / "verdicts", Path(options.bin), 1) as daemon:
        ours = {path: daemon.verdict(path) for *_, path in files}
    for kind, name, path in files:
        errors, words = theirs[path], ours[path]
        differ = bool(errors) != bool(words) or words.startswith("CRASHED")
        row = {"kind": kind, "name": name, "errors": errors, "ours": words,
               "why": reason(name, errors, words) if differ else ""}
        rows.append(row)
        if row["why"] is None:
            print(f"UNEXPLAINED {name}: validator {sorted({e[0] for e in errors})}, raykiln: {words or 'takes it'}", flush=True)
    (WORK / "verdicts.json").write_text(json.dumps(rows, indent=1))
    print(summary(rows))
    if options.readme:
        write_readme(summary(rows))
    failed = sum(r["why"] is None for r in rows)
    print(f"{len(rows) - failed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
