"""Builds and runs the suites of tests/run, and adds up what they say.

A suite is a name, the builds it needs, and a function that runs it and returns a Tally.
Whatever cannot be built or started counts as one failure of every suite that needs it: the
last line can only say "0 failed" when everything ran.
"""

import argparse
import os
import shutil
import signal
import sys
import time
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Callable

import console
import tallies
from tallies import Tally

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build"
LOGS = BUILD / "test-logs"
JOBS = os.environ.get("RAYKILN_JOBS") or str(os.cpu_count() or 2)
PYTEST = ["/usr/bin/python3", "-B", "-m", "pytest", "-p", "no:cacheprovider", "-v", "--tb=short"]
READERS = ["unit/io", "unit/jobs", "property/jobs", "fuzz"]
SERVER = [f"unit/{m}" for m in
          ("base", "jobs", "store", "events", "workers", "scheduler", "api", "http", "app")]
SERVER.append("property/jobs")
SANITIZERS = {
    "ASAN_OPTIONS": "detect_stack_use_after_return=1:strict_string_checks=1:abort_on_error=0",
    "UBSAN_OPTIONS": "print_stacktrace=1:halt_on_error=1",
    "TSAN_OPTIONS": "halt_on_error=1:second_deadlock_stack=1:"
                    f"suppressions={ROOT / 'tests/support/tsan_suppressions.txt'}",
}


@dataclass
class Suite:
    name: str
    what: str
    run: Callable[[], Tally]
    needs: list = field(default_factory=list)
    full_only: bool = False
    may_be_skipped: bool = False  # wants what only a network has; says so when it is skipped
    part_of: str = ""  # the suite of --full that runs all of this one again, so that it can be left out


class BuildFailed(Exception):
    pass


class Builds:
    """Runs each build once, when the first suite asks for it."""

    def __init__(self):
        self.done = {}
        self.seconds = {}

    def require(self, name):
        if name not in self.done:
            for before in BUILT_BEFORE.get(name, []):
                self.require(before)
            start = time.monotonic()
            self.done[name] = RECIPES[name]()
            self.seconds[name] = time.monotonic() - start
        if not self.done[name]:
            raise BuildFailed(name)


def log_of(name) -> Path:
    return LOGS / f"{name}.log"


def step(name, command, **options) -> int:
    return console.run(name, command, log_of(name), cwd=options.pop("cwd", ROOT), **options)


def build_preset(preset, *targets) -> bool:
    name = f"build-{preset}"
    configured = step(name, ["cmake", "--preset", preset]) == 0
    return configured and step(
        name, ["cmake", "--build", "--preset", preset, "-j", JOBS, "--", *targets]) == 0


def folders_in(preset, folders):
    """The test folders that this tree has, as build directories of the preset."""
    return [f for f in folders if (BUILD / preset / "tests" / f).is_dir()]


def build_folders(preset, folders, *extra) -> bool:
    name = f"build-{preset}"
    if step(name, ["cmake", "--preset", preset]) != 0:
        return False
    targets = [f"tests/{f}/all" for f in folders_in(preset, folders)] + list(extra)
    # Without a target ninja would build everything, which is not what was asked.
    return bool(targets) and step(name, ["ninja", "-C", str(BUILD / preset), "-j", JOBS, *targets]) == 0


RECIPES = {
    "test": lambda: build_preset("test"),
    "web": lambda: step("build-web", ["docker/build_web.sh"]) == 0,
    "readers": lambda: build_folders("asan-ubsan", READERS),
    "asan-ubsan": lambda: build_preset("asan-ubsan"),
    "tsan": lambda: build_folders("tsan", SERVER, "raykilnd", "raykiln"),
}

# The daemon carries the page inside, so the page comes first.
BUILT_BEFORE = {name: ["web"] for name in ("test", "asan-ubsan", "tsan")}


def ctest(name, directory, env=None, extra=()) -> Tally:
    junit, wholes = LOGS / f"{name}.xml", BUILD / directory.relative_to(BUILD).parts[0] / "gtest"
    shutil.rmtree(wholes, ignore_errors=True)
    code = step(name, ["ctest", "--test-dir", str(directory), "-j", JOBS, "--output-on-failure",
                       "--no-tests=error", "--output-junit", str(junit), *extra], env=env)
    return tallies.from_ctest(junit, code, wholes)


def ctest_folders(name, preset, folders, env) -> Tally:
    total = Tally()
    for folder in folders_in(preset, folders):
        part = ctest(f"{name}-{folder.replace('/', '-')}", BUILD / preset / "tests" / folder, env)
        total = total + part
    return total if total.ran else Tally(failed=1, names=["no test folder to run"])


def pytest(name, *what, preset="test", env=None) -> Tally:
    junit = LOGS / f"{name}.xml"
    environment = {"RAYKILN_BIN_DIR": str(BUILD / preset / "bin"), **(env or {})}
    code = step(name, [*PYTEST, f"--junitxml={junit}", *what], env=environment)
    return tallies.from_junit(junit, code)


def vitest() -> Tally:
    junit = LOGS / "vitest.xml"
    code = step("vitest", ["npx", "--no-install", "vitest", "run", "--reporter=default",
                           "--reporter=junit", f"--outputFile.junit={junit}"], cwd=ROOT / "web")
    return tallies.from_junit(junit, code)


def page() -> Tally:
    code = step("page", ["node", "tests/e2e/page/run.mjs"],
                env={"RAYKILN_BIN_DIR": str(BUILD / "test" / "bin")})
    return tallies.from_last_line(log_of("page"), code)


def peer() -> Tally:
    code = step("peer", ["tests/peer/run"], env={"RAYKILN_BIN_DIR": str(BUILD / "test" / "bin")})
    if code == NOTHING_TO_ASK:
        print("   SKIPPED: neither mitsuba nor gltf-validator can be installed here", flush=True)
        return Tally(skipped=1)
    return tallies.from_last_line(log_of("peer"), code)


def unit(leave_out=()) -> Tally:
    return ctest("unit", BUILD / "test", extra=leave_out)


def long_statistics() -> Tally:
    return ctest("long", BUILD / "test", {"RAYKILN_LONG": "1"}, ["-L", LONG_LABELS])


LONG_LABELS = "golden|property|hard"
NOTHING_TO_ASK = 77  # tests/peer/run, where the package indexes have no other program
NOT_SIZE = ["-m", "not size"]
# Without tests that state a time, files of tests may run side by side.
SIDE_BY_SIDE = ["-n", JOBS, "--dist", "loadfile"]
NOT_MEASURED = ["-m", "not size and not measured", *SIDE_BY_SIDE]
THREADED = ["-m", "not size and not measured and not one_thread", *SIDE_BY_SIDE]

SUITES = [
    Suite("hygiene", "what the tree may hold and which module may use what",
          lambda: pytest("hygiene", "tests/hygiene/test_tree.py")),
    Suite("unit", "every C++ test, through ctest (--full: those of 'long' only there)", unit, ["test"]),
    Suite("packaging", "installed programs start with the libraries of run.txt",
          lambda: pytest("packaging", "tests/hygiene/test_packaging.py"), ["web", "test"]),
    Suite("e2e", "the daemon and the CLI from outside", lambda: pytest("e2e", "tests/e2e", *NOT_SIZE),
          ["web", "test"]),
    Suite("vitest", "the page's own modules", vitest, ["web"]),
    Suite("page", "the page in headless Chromium", page, ["web", "test"]),
    Suite("readers", "renderer/io and server/jobs under ASan and UBSan",
          lambda: ctest_folders("readers", "asan-ubsan", READERS, SANITIZERS), ["readers"],
          part_of="asan"),
    Suite("asan", "every C++ test under ASan and UBSan",
          lambda: ctest("asan", BUILD / "asan-ubsan", SANITIZERS), ["asan-ubsan"], True),
    Suite("asan-e2e", "the daemon from outside, under ASan and UBSan",
          lambda: pytest("asan-e2e", "tests/e2e", *NOT_MEASURED, preset="asan-ubsan",
                         env={**SANITIZERS, "RAYKILN_SLOW": "8", "RAYKILN_COST": "3"}), ["web", "asan-ubsan"], True),
    Suite("tsan", "the server's C++ tests under TSan",
          lambda: ctest_folders("tsan", "tsan", SERVER, SANITIZERS), ["tsan"], True),
    Suite("tsan-e2e", "the daemon from outside, under TSan",
          lambda: pytest("tsan-e2e", "tests/e2e", *THREADED, preset="tsan",
                         env={**SANITIZERS, "RAYKILN_SLOW": "15", "RAYKILN_COST": "10"}), ["web", "tsan"], True),
    Suite("long", "golden, property and hard tests with their long sample counts", long_statistics,
          ["test"], True),
    Suite("long-e2e", "the daemon's tests of many pictures and of a minute's patience",
          lambda: pytest("long-e2e", "tests/e2e", "-m", "long", env={"RAYKILN_LONG": "1"}),
          ["web", "test"], True),
    Suite("size", "a scan of 871 thousand triangles, uploaded and rendered",
          lambda: pytest("size", "tests/e2e", "-m", "size"), ["web", "test"], True),
    Suite("peer", "pictures beside Mitsuba 3, verdicts beside the Khronos glTF validator", peer,
          ["test"], True, may_be_skipped=True),
]


def run_suite(suite, builds) -> Tally:
    start = time.monotonic()
    try:
        for need in suite.needs:
            builds.require(need)
        start = time.monotonic()
        tally = suite.run()
    except BuildFailed as failure:
        tally = Tally(failed=1, names=[f"build '{failure}' failed"])
    except OSError as error:
        tally = Tally(failed=1, names=[f"could not be started: {error}"])
    if not tally.ran and not (suite.may_be_skipped and tally.skipped):
        tally = Tally(failed=1, names=["ran no test"])
    tally.seconds = time.monotonic() - start
    return tally


def report(results, builds, started):
    print()
    for name, seconds in builds.seconds.items():
        state = "built" if builds.done[name] else f"FAILED, see {LOGS.relative_to(ROOT)}"
        print(f"  build {name:<12} {seconds:7.1f} s  {state}")
    for suite, tally in results:
        skipped = f", {tally.skipped} skipped" if tally.skipped else ""
        print(f"  {suite.name:<18} {tally.seconds:7.1f} s  "
              f"{tally.passed} passed, {tally.failed} failed{skipped}")
        for name in tally.names[:20]:
            print(f"      failed: {name}")
        if len(tally.names) > 20:
            print(f"      and {len(tally.names) - 20} more; see {LOGS.relative_to(ROOT)}")
    print(f"  all of it          {time.monotonic() - started:7.1f} s; logs in {LOGS.relative_to(ROOT)}")
    passed = sum(t.passed for _, t in results)
    failed = sum(t.failed for _, t in results)
    print(f"{passed} passed, {failed} failed", flush=True)
    return 0 if failed == 0 and passed > 0 else 1


def parse(arguments):
    parser = argparse.ArgumentParser(
        prog="tests/run", description="Installs, builds, and runs the tests. The last line is "
        "'N passed, N failed'; logs are in build/test-logs.",
        epilog="exit: 0 all passed, 1 something failed, 2 wrong usage. RAYKILN_JOBS sets how many "
        "compilers and tests run at once (the number of cores).")
    parser.add_argument("--full", action="store_true",
                        help="also everything under ASan+UBSan, the server under TSan, the long "
                        "statistics and the size test")
    parser.add_argument("--only", action="append", metavar="SUITE", default=[],
                        help="run this suite alone (may be given again)")
    parser.add_argument("--list", action="store_true", help="list the suites and stop")
    parser.add_argument("--no-install", action="store_true", help="install no package")
    options = parser.parse_args(arguments)
    unknown = set(options.only) - {s.name for s in SUITES}
    if unknown:
        parser.error(f"no suite named {', '.join(sorted(unknown))}; --list names them")
    return options


def chosen_suites(options):
    """What --full runs in a longer form it does not run in the short one as well."""
    if options.only:
        return [s for s in SUITES if s.name in options.only]
    if not options.full:
        return [s for s in SUITES if not s.full_only]
    once = [s for s in SUITES if not s.part_of]
    return [replace(s, run=lambda: unit(["-LE", LONG_LABELS])) if s.name == "unit" else s for s in once]


def main(arguments) -> int:
    options = parse(arguments)
    if options.list:
        for suite in SUITES:
            print(f"{suite.name:<12} {suite.what}{' (--full)' if suite.full_only else ''}")
        return 0
    # So that what was started is ended on SIGTERM as it is on Ctrl-C.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    shutil.rmtree(LOGS, ignore_errors=True)
    LOGS.mkdir(parents=True)
    chosen = chosen_suites(options)
    builds, started = Builds(), time.monotonic()
    results = [(suite, run_suite(suite, builds)) for suite in chosen]
    return report(results, builds, started)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
