"""What `cmake --install` puts into a directory starts, with the libraries of run.txt alone."""

import os
import re
import subprocess
import time
import urllib.request
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ROOT / "docker" / "packages"
BIN = Path(os.environ.get("RAYKILN_BIN_DIR", ROOT / "build" / "test" / "bin"))
SETS = ("build", "run", "test")


def names(which: str) -> list:
    lines = (PACKAGES / f"{which}.txt").read_text().splitlines()
    return [line.split()[0] for line in lines if line.strip() and not line.startswith("#")]


def run(*command, **options) -> subprocess.CompletedProcess:
    return subprocess.run(command, capture_output=True, text=True, check=False, **options)


@pytest.fixture(scope="module")
def staging(tmp_path_factory):
    prefix = tmp_path_factory.mktemp("prefix")
    installed = run("cmake", "--install", str(BIN.parent), "--prefix", str(prefix))
    assert installed.returncode == 0, installed.stdout + installed.stderr
    return prefix


@pytest.mark.parametrize("which", SETS)
def test_lists_name_packages_that_exist(which):
    shown = run("apt-cache", "policy", *names(which)).stdout
    known = re.findall(r"^(\S+):\n  Installed: (.+)\n  Candidate: (.+)$", shown, re.M)
    found = {name for name, *versions in known if set(versions) != {"(none)"}}
    assert found == set(names(which))
    assert len(set(names(which))) == len(names(which))


def test_boost_is_1_81_alone():
    for which in SETS:
        assert not [n for n in names(which) if n.startswith("libboost") and "1.81" not in n]


def test_the_install_script_is_quick_and_silent_when_all_is_there():
    least = 60.0
    for _ in range(20):  # others on a machine only ever add to a time
        start = time.monotonic()
        done = run(str(ROOT / "docker" / "install.sh"), "build", "run", "test")
        assert (done.returncode, done.stdout + done.stderr) == (0, "")
        least = min(least, time.monotonic() - start)
        if least < 1:
            break
    assert least < 1


def test_the_install_script_refuses_wrong_usage():
    script = str(ROOT / "docker" / "install.sh")
    assert run(script).returncode == 2
    assert "unknown set 'games'" in run(script, "games").stderr


def test_the_install_script_names_what_is_missing(tmp_path):
    copy = tmp_path / "docker"
    (copy / "packages").mkdir(parents=True)
    script = copy / "install.sh"
    script.write_bytes((ROOT / "docker" / "install.sh").read_bytes())
    script.chmod(0o755)
    (copy / "packages" / "run.txt").write_text("bash\nno-such-package-here\n")
    checked = run(str(script), "--check", "run")
    assert checked.returncode == 1 and "missing: no-such-package-here" in checked.stderr


def libraries(program: Path) -> dict:
    """Library name -> path, as the loader resolves them."""
    printed = run("ldd", str(program)).stdout
    assert "not found" not in printed, printed
    return dict(re.findall(r"^\s*(\S+) => (/\S+)", printed, re.M))


def closure_of_run_packages() -> set:
    """The packages of run.txt and all they depend on, and Debian's base (libc, libstdc++)."""
    printed = run("apt-cache", "depends", "--recurse", "--no-recommends", "--no-suggests",
                  "--no-conflicts", "--no-breaks", "--no-replaces", "--no-enhances",
                  "--installed", *names("run"), "libc6", "libstdc++6").stdout
    return set(re.findall(r"^(\w[\w.+-]*)", printed, re.M))


@pytest.mark.parametrize("program", ["raykilnd", "raykiln"])
def test_libraries_come_from_run_txt(staging, program):
    allowed = closure_of_run_packages()
    assert len(allowed) > len(names("run"))
    found = libraries(staging / "bin" / program)
    # /lib is a link to /usr/lib; dpkg knows some files by the one name, some by the other.
    spellings = {path: {path, str(Path(path).resolve()), path.replace("/usr", "", 1), f"/usr{path}"}
                 for path in found.values()}
    # One call for all: dpkg -S reads the lists of every package each time.
    printed = run("dpkg", "-S", *{place for places in spellings.values() for place in places}).stdout
    owners = {path: set(owner.split(":")[0] for owner in names_of.split(", "))
              for names_of, path in re.findall(r"^(\S.*?): (/.*)$", printed, re.M)}
    for name, path in found.items():
        owner = set().union(*(owners.get(place, set()) for place in spellings[path]))
        assert owner, f"{name} ({path}) belongs to no package"
        assert owner & allowed, f"{name} belongs to {owner}, which run.txt does not bring"


def test_the_installed_programs_start(staging, tmp_path):
    assert run(str(staging / "bin" / "raykiln"), "--version").returncode == 0
    log = tmp_path / "log"
    with open(log, "w") as sink:
        # No build directory, no source tree: an empty working directory and environment.
        daemon = subprocess.Popen([str(staging / "bin" / "raykilnd"), "--listen", "127.0.0.1:0",
                                   "--store", str(tmp_path / "store")], cwd=tmp_path,
                                  env={"PATH": "/usr/bin:/bin"}, stdout=sink, stderr=sink)
    try:
        url = listening(log, daemon)
        page = urllib.request.urlopen(url + "/", timeout=120).read().decode()
        assert "<script" in page, "the installed daemon must find the installed page"
        health = run(str(staging / "bin" / "raykiln"), "health", "--server", url)
        assert health.returncode == 0, health.stderr
    finally:
        daemon.terminate()
        assert daemon.wait(120) == 0
    assert run(str(staging / "bin" / "raykiln"), "health", "--server", url).returncode != 0


def listening(log: Path, daemon) -> str:
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline and daemon.poll() is None:
        found = re.search(r"http://127\.0\.0\.1:\d+", log.read_text())
        if found:
            return found.group(0)
        time.sleep(0.02)
    raise AssertionError(log.read_text())


def dockerfile() -> str:
    return re.sub(r"\\\n", " ", (ROOT / "docker" / "Dockerfile").read_text())


def test_the_dockerfile_copies_what_exists():
    for source in re.findall(r"^COPY (?!--from)(\S+)", dockerfile(), re.M):
        assert (ROOT / source).exists(), source


def test_the_dockerfile_is_not_root_and_has_a_health_check():
    final = dockerfile().split("\nFROM ")[-1]
    assert re.search(r"^USER raykiln$", final, re.M)
    assert re.search(r"^HEALTHCHECK .*\"raykiln\", \"health\"", final, re.M)
    assert "docker/install.sh run" in final and "docker/install.sh build" in dockerfile()
    assert re.search(r"^EXPOSE 8080$", final, re.M) and re.search(r"^VOLUME ", final, re.M)


def test_the_dockerfiles_options_are_known(staging):
    """Each --option of ENTRYPOINT, CMD and HEALTHCHECK is one that the program has."""
    final = dockerfile().split("\nFROM ")[-1]
    for program, *words in (re.findall(r'"([^"]+)"', line) for line in
                            re.findall(r"^(?:ENTRYPOINT|HEALTHCHECK.*CMD) *(\[.*\])$", final, re.M)):
        path = str(staging / "bin" / program)
        shown = run(path, "--help").stdout
        if "health" in words:
            shown += run(path, "health", "--help").stdout
        for word in words:
            assert not word.startswith("--") or word in shown, f"{program} has no {word}"
    extra = re.search(r"^CMD (\[.*\])$", final, re.M)
    shown = run(str(staging / "bin" / "raykilnd"), "--help").stdout
    for word in re.findall(r'"(--[\w-]+)"', extra.group(1)):
        assert word in shown, word


