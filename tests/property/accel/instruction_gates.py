"""Instructions a ray may only get fewer: counts by valgrind's callgrind beside a committed table.

usage: instruction_gates.py PROGRAM TABLE COMPILER

PROGRAM is walk_instructions; COMPILER names the one that built it, with its major version. A figure
of more than TOLERANCE over the table fails. Exit 77, which counts as skipped: without valgrind, or
where another compiler than the table's was used. With RAYKILN_REWRITE_GATES set, the table is
written anew.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

# Counts repeat to the instruction but for copies whose path depends on where memory lies (below 0.1 %);
# the rest is for releases of one major version of the compiler.
TOLERANCE = 0.02
SKIPPED = 77


def skip(reason) -> int:
    print(f"skipped: {reason}")
    return SKIPPED


def collected(dump: Path) -> int:
    for line in dump.read_text().splitlines():
        if line.startswith(("summary:", "totals:")):
            return int(line.split()[1])
    raise ValueError(f"no total in {dump.name}")


def measure(valgrind, program) -> dict:
    """Instructions a ray by "scene rays kernel"; valgrind knows no AVX-512."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "calls"
        run = subprocess.run(
            [valgrind, "--tool=callgrind", "--collect-atstart=no", "--toggle-collect=trace_rays",
             "--dump-after=trace_rays", f"--callgrind-out-file={out}", program],
            capture_output=True, text=True, check=False)
        if run.returncode != 0:
            raise RuntimeError(run.stderr[-2000:])
        figures = {}
        for call, line in enumerate(run.stdout.splitlines(), start=1):
            scene, rays, kernel, count = line.split()
            instructions = collected(out.with_name(f"calls.{call}"))
            figures[f"{scene} {rays} {kernel}"] = instructions / int(count)
        return figures


def read_table(path: Path):
    lines = path.read_text().splitlines() if path.exists() else []
    compiler = lines[0].removeprefix("# ") if lines else ""
    return compiler, {name: float(value) for name, value in
                      (line.rsplit(" ", 1) for line in lines[1:])}


def compare(figures, table) -> int:
    worse = 0
    for name, value in figures.items():
        before = table.get(name)
        verdict = "as before"
        if before is None or value > before * (1 + TOLERANCE):
            verdict, worse = "WORSE", worse + 1
        elif value < before * (1 - TOLERANCE):
            verdict = "better: keep it with RAYKILN_REWRITE_GATES=1"
        print(f"{name:<24} {value:8.1f} instructions a ray, in the table {before}: {verdict}")
    # A processor without a kernel has none of its rows; a row that is missing beside others of its kernel is lost.
    kernels = {name.split()[-1] for name in figures}
    lost = [name for name in table if name.split()[-1] in kernels and name not in figures]
    for name in lost:
        print(f"{name:<24} was not measured")
    return 1 if worse or lost or not figures else 0


def main(program, table, compiler) -> int:
    valgrind = shutil.which("valgrind")
    if valgrind is None:
        return skip("valgrind is not installed")
    rewrite = "RAYKILN_REWRITE_GATES" in os.environ
    built_by, before = read_table(Path(table))
    if not rewrite and built_by != compiler:
        return skip(f"the table is of {built_by or 'nothing'}, this program of {compiler}")
    figures = measure(valgrind, program)
    if rewrite:
        lines = [f"# {compiler}", *(f"{name} {value:.1f}" for name, value in sorted(figures.items()))]
        Path(table).write_text("\n".join(lines) + "\n")
        return 0
    return compare(figures, before)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
