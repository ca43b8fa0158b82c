"""raykiln compare, batch and approve: verdicts, reports and exit codes."""

import json
import os
import shutil
import signal
import subprocess
import time

import jsonschema
import pytest
import yaml

from support import scenes
from support.daemon import ROOT, SLOW, fewer
from support.junit import read_junit
from support.patience import least_of_turns
from support.proxy import Proxy
from test_cli import PROGRAM, raykiln
from test_reuse import counter

FILE_SCHEMA = json.loads((ROOT / "proto" / "batch.schema.json").read_text())
REPORT_SCHEMA = json.loads((ROOT / "proto" / "batch-report.schema.json").read_text())
NAMES = ("one", "two", "three", "four", "changed", "broken")


def write_scene(folder, name, grey="0.7 0.7 0.7"):
    target = folder / name
    target.mkdir(parents=True, exist_ok=True)
    for file, content in scenes.box_files(name).items():
        (target / file).write_text(content.replace("Kd 0.7 0.7 0.7", f"Kd {grey}"))
    return target


def plan(folder, names=NAMES, **fields):
    """A batch file of these scenes; returns its path."""
    content = {
        "name": "six", "reference": "refs/{name}.exr",
        "defaults": {"width": 48, "height": 36, "stop": {"samples": 32}, "seed": 1},
        "scenes": [{"scene": f"scenes/{name}", "name": name} for name in names], **fields}
    jsonschema.validate(content, FILE_SCHEMA)
    path = folder / "batch.yaml"
    path.write_text(yaml.safe_dump(content))
    return path


def run(path, *words, timeout=300):
    done = raykiln("batch", path, "--html", path.parent / "report", "--junit", path.parent / "junit.xml",
                   *words, timeout=timeout)
    results = path.parent / "report" / "results.json"
    report = json.loads(results.read_text()) if results.exists() else None
    if report:
        jsonschema.validate(report, REPORT_SCHEMA)
        assert report["exit_code"] == done.returncode
    return done, report


def check_junit(path, counts):
    suite = read_junit(path)
    assert {k: int(suite.get(k)) for k in counts} == counts


def verdicts(report):
    return {picture["name"]: picture["verdict"] for picture in report["pictures"]}


@pytest.fixture(scope="module")
def gallery(tmp_path_factory):
    """A folder whose references have been approved, and in which one scene has changed since."""
    folder = tmp_path_factory.mktemp("gallery")
    for name in NAMES[:-1]:
        write_scene(folder / "scenes", name)
    first, report = run(plan(folder, NAMES[:-1]), "--local")
    assert first.returncode == 11, first.stderr
    assert set(verdicts(report).values()) == {"no_reference"}
    approved = raykiln("approve", folder / "report", "--all")
    assert approved.returncode == 0 and len(approved.stdout.splitlines()) == 5, approved.stderr
    write_scene(folder / "scenes", "changed", grey="0.6 0.6 0.6")
    write_scene(folder / "scenes", "broken")
    (folder / "scenes" / "broken" / "box.obj").write_text("v nan 0 0\n")
    return folder


def copy(gallery, tmp_path):
    shutil.copytree(gallery, tmp_path / "gallery", dirs_exist_ok=True)
    return tmp_path / "gallery"


OTHER_SEED = {"width": 48, "height": 36, "stop": {"samples": 32}, "seed": 2}


@pytest.fixture(params=["local", "server"])
def where(request):
    """The words that say who renders."""
    if request.param == "local":
        return ("--local",)
    return ("--server", request.getfixturevalue("api").daemon.url)


def test_six_scenes_one_broken_one_changed(gallery, tmp_path, where):
    folder = copy(gallery, tmp_path)
    done, report = run(plan(folder, defaults=OTHER_SEED), *where)
    assert done.returncode == 4, done.stderr
    assert verdicts(report) == {"one": "same", "two": "same", "three": "same", "four": "same",
                                "changed": "differs", "broken": "failed"}
    broken = report["pictures"][-1]
    assert "box.obj:1" in broken["failure"]
    assert all(p["comparison"]["method"] == "noise" for p in report["pictures"][:-1])
    assert report["pictures"][0]["error"] > 0
    check_junit(folder / "junit.xml", {"tests": 6, "failures": 1, "errors": 1, "skipped": 0})
    check_page(folder / "report" / "index.html", pictures=5 * 4)


def check_page(page, pictures):
    """Opens the report: scripts run without an error, and no picture is torn."""
    html = page.read_text()
    assert html.count("<img ") == pictures
    probe = page.with_name("probe.html")
    probe.write_text(html.replace("</body>", """<script>
window.addEventListener('load', () => {
  document.dispatchEvent(new KeyboardEvent('keydown', {key: '3'}));
  document.title = [...document.images].filter((i) => i.complete && i.naturalWidth > 0).length + ' whole, ' +
    [...document.querySelectorAll('img.shown')].filter((i) => i.dataset.kind === 'difference').length + ' shown';
});</script></body>"""))
    chromium = shutil.which("chromium") or pytest.fail("chromium is missing")
    shown = subprocess.run(
        [chromium, "--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr", "--dump-dom",
         "--virtual-time-budget=5000", f"--user-data-dir={page.parent / 'profile'}", probe.as_uri()],
        capture_output=True, text=True, timeout=180 * SLOW, check=False)
    assert f"<title>{pictures} whole, {pictures // 4} shown</title>" in shown.stdout, shown.stdout[-500:] + shown.stderr
    assert "CONSOLE" not in shown.stderr, shown.stderr


def test_exit_codes_follow_the_gravest_outcome(gallery, tmp_path, where):
    folder = copy(gallery, tmp_path)
    assert run(plan(folder, ("one", "two"), defaults=OTHER_SEED), *where)[0].returncode == 0
    assert run(plan(folder, ("one", "changed"), defaults=OTHER_SEED), *where)[0].returncode == 11
    assert run(plan(folder, ("changed", "broken"), defaults=OTHER_SEED), *where)[0].returncode == 4
    hopeless = {**OTHER_SEED, "stop": {"samples": 64, "error": 0.0001}}
    assert run(plan(folder, ("one",), defaults=hopeless), *where)[0].returncode == 12
    assert raykiln("batch", folder / "none.yaml", "--local").returncode == 3
    (folder / "bad.yaml").write_text("scenes: [{scene: a.obj, colour: red}]")
    bad = raykiln("batch", folder / "bad.yaml", "--local")
    assert bad.returncode == 2 and "colour" in bad.stderr and "line 1" in bad.stderr


def test_fail_fast_skips_the_rest(gallery, tmp_path, where):
    folder = copy(gallery, tmp_path)
    done, report = run(plan(folder, ("broken", "one", "two"), fail_fast=True, max_active=1), *where)
    assert done.returncode == 4
    assert verdicts(report) == {"broken": "failed", "one": "skipped", "two": "skipped"}
    check_junit(folder / "junit.xml", {"tests": 3, "failures": 0, "errors": 1, "skipped": 2})


def test_an_unchanged_batch_is_reused_and_quick(launch, tmp_path):
    """20 scenes: a few requests each, no sample, and the report says so."""
    api = launch()
    names = [f"s{n}" for n in range(20)]
    for name in names:
        write_scene(tmp_path / "scenes", name)
    samples = fewer(32)
    path = plan(tmp_path, names, max_active=16,
                defaults={"width": 48, "height": 36, "stop": {"samples": samples}, "seed": 1})
    first, report = run(path, "--server", api.daemon.url)
    assert first.returncode == 11 and report["counts"]["reused"] == 0
    assert raykiln("approve", tmp_path / "report", "--all").returncode == 0
    rendered, asked = counter(api, "raykiln_samples_total"), requests_of(api)
    assert rendered == 20 * 48 * 36 * samples
    begun = time.monotonic()
    second, report = run(path, "--server", api.daemon.url)
    seconds = time.monotonic() - begun
    assert second.returncode == 0, second.stderr
    assert report["counts"]["reused"] == 20 and all(p["reused"] and p["seconds"] == 0 for p in report["pictures"])
    assert counter(api, "raykiln_samples_total") == rendered
    assert requests_of(api) - asked <= 20 * 3 + 20 + 10 * seconds, "job and picture of each, and a few looks at the batch"
    assert "reused" in (tmp_path / "report" / "index.html").read_text() and "20 reused" in second.stderr
    print(f"20 unchanged scenes: {seconds:.2f} s")
    again, report = run(path, "--no-reuse", "--server", api.daemon.url)
    assert again.returncode == 0 and report["counts"]["reused"] == 0
    assert counter(api, "raykiln_samples_total") == 2 * rendered


@pytest.mark.measured
def test_an_unchanged_batch_takes_under_two_seconds(launch, tmp_path):
    api = launch()
    names = [f"s{n}" for n in range(20)]
    for name in names:
        write_scene(tmp_path / "scenes", name)
    path = plan(tmp_path, names, max_active=16)
    run(path, "--server", api.daemon.url)

    def turn():
        begun = time.monotonic()
        assert run(path, "--server", api.daemon.url)[1]["counts"]["reused"] == 20
        return time.monotonic() - begun

    assert least_of_turns(turn, promised=2.0 * SLOW) <= 2.0 * SLOW


def requests_of(api):
    """Requests that the daemon has answered."""
    lines = [line for line in api.get("/metrics").text.splitlines() if line.startswith("raykiln_http_requests_total")]
    assert lines
    return sum(float(line.rsplit(" ", 1)[1]) for line in lines)


ENDLESS = {"width": 128, "height": 96, "stop": {"samples": 1000000}, "seed": 1}


def start(path, api, *words):
    """A batch that goes on for ever, and its id."""
    program = subprocess.Popen([PROGRAM, "batch", str(path), "--server", api.daemon.url, "--wait", *map(str, words)],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, stdin=subprocess.DEVNULL)
    line = program.stderr.readline()
    assert line.startswith("batch b_"), line
    return program, line.split()[1]


def batch_state(api, batch):
    return api.json(f"/v1/batches/{batch}")["state"]


def test_ctrl_c_detaches_and_the_batch_goes_on(gallery, tmp_path, launch):
    api, folder = launch(), copy(gallery, tmp_path)
    path = plan(folder, ("one", "two"), defaults=ENDLESS)
    program, batch = start(path, api, "--junit", folder / "junit.xml")
    program.send_signal(signal.SIGINT)
    out, err = program.communicate(timeout=180 * SLOW)
    assert program.returncode == 13 and out.strip() == batch and f"--resume {batch}" in err
    assert batch_state(api, batch) == "running"
    check_junit(folder / "junit.xml", {"tests": 2, "skipped": 2})
    late = raykiln("batch", path, "--server", api.daemon.url, "--wait", "--resume", batch, "--timeout", "0.5")
    assert late.returncode == 13 and late.stdout.strip() == batch
    # A batch that was sent and not to be waited for.
    sent = raykiln("batch", path, "--server", api.daemon.url, "--idempotency-key", "once")
    assert sent.returncode == 0 and sent.stdout.startswith("b_")
    assert raykiln("batch", path, "--server", api.daemon.url, "--idempotency-key", "once").stdout == sent.stdout


def test_ctrl_c_cancels_where_that_is_asked_for(gallery, tmp_path, launch):
    api, folder = launch(), copy(gallery, tmp_path)
    path = plan(folder, ("one", "two"), defaults=ENDLESS)
    program, batch = start(path, api, "--cancel-on-interrupt", "--report", folder / "out.json")
    program.send_signal(signal.SIGINT)
    program.communicate(timeout=180 * SLOW)
    assert program.returncode == 5 and batch_state(api, batch) == "cancelled"
    assert set(verdicts(json.loads((folder / "out.json").read_text())).values()) == {"cancelled"}


def test_what_failed_is_run_again(gallery, tmp_path, launch):
    api, folder = launch(), copy(gallery, tmp_path)
    path = plan(folder, ("one", "two"), defaults=OTHER_SEED)
    done, report = run(path, "--server", api.daemon.url)
    assert done.returncode == 0
    batch = report["batch"]
    done, report = run(path, "--server", api.daemon.url, "--resume", batch, "--rerun")
    assert done.returncode == 0 and report["batch"] == batch


def test_a_server_that_is_not_there(gallery, tmp_path):
    path = plan(copy(gallery, tmp_path), ("one",))
    done = raykiln("batch", path, "--wait", "--server", "http://127.0.0.1:9")
    assert done.returncode == 6, done.stderr


def test_a_server_that_comes_back_is_asked_again(gallery, tmp_path, api):
    """Connections that are lost and 503 while results are fetched: the batch goes on as if nothing had been."""
    folder, faults = copy(gallery, tmp_path), ["drop", 503, "drop"]

    def fault(method, target):
        if method == "GET" and ("/image" in target or target.startswith("/v1/jobs/")) and faults:
            return faults.pop(0)
        return None

    with Proxy(api.daemon.port, fault) as proxy:
        done, report = run(plan(folder, ("one", "two"), defaults=OTHER_SEED), "--server", proxy.url)
    assert done.returncode == 0 and not faults, done.stderr
    assert verdicts(report) == {"one": "same", "two": "same"}


@pytest.mark.long
@pytest.mark.skipif(os.environ.get("RAYKILN_LONG") != "1", reason="RAYKILN_LONG=1: patience takes a minute")
def test_a_server_that_stays_away_has_a_code_of_its_own(gallery, tmp_path, api):
    path = plan(copy(gallery, tmp_path), ("one", "two"), defaults=OTHER_SEED)
    gone = []

    def fault(method, target):
        if "/image" in target or gone:
            gone.append(target)
            return "drop" if len(gone) % 2 else 503
        return None

    with Proxy(api.daemon.port, fault) as proxy:
        begun = time.monotonic()
        done = raykiln("batch", path, "--server", proxy.url, "--junit", tmp_path / "junit.xml", "--html", tmp_path / "report",
                       timeout=180.0)
    assert done.returncode == 6 and 60 < time.monotonic() - begun < 120 + 60 * SLOW, done.stderr
    assert "--resume" in done.stderr and "b_" in done.stderr and 10 <= len(gone) < 60, (done.stderr, gone)


def test_progress_without_a_terminal_is_plain_lines(gallery, tmp_path, where):
    done, _ = run(plan(copy(gallery, tmp_path), ("one", "two"), defaults=OTHER_SEED), *where)
    assert "\x1b" not in done.stderr and "\r" not in done.stderr
    assert {line.split(":")[0] for line in done.stderr.splitlines()} >= {"one", "two"}


def test_bars_on_a_terminal(gallery, tmp_path, api):
    path = plan(copy(gallery, tmp_path), ("one", "two"), defaults={**ENDLESS, "stop": {"samples": 60}})
    command = [PROGRAM, "batch", str(path), "--server", api.daemon.url, "--wait", "--no-reuse"]
    shown = subprocess.run(["script", "-qec", " ".join(command), "/dev/null"], capture_output=True, text=True, check=False,
                           timeout=300 * SLOW, stdin=subprocess.DEVNULL, env={"PATH": "/usr/bin:/bin", "NO_COLOR": "1"})
    assert "all [" in shown.stdout and "/2" in shown.stdout, shown.stdout[-800:]
    assert "\x1b[3" not in shown.stdout, "no colours"


def test_approve_takes_names(gallery, tmp_path):
    folder = copy(gallery, tmp_path)
    path = plan(folder, ("one", "changed"), defaults=OTHER_SEED)
    assert run(path, "--local")[0].returncode == 11
    assert raykiln("approve", folder / "report", "nobody").returncode == 8
    assert raykiln("approve", folder / "report", "changed").stdout.startswith("changed -> ")
    assert run(path, "--local")[0].returncode == 0


def test_github_gets_annotations_and_a_summary(gallery, tmp_path, monkeypatch):
    folder = copy(gallery, tmp_path)
    summary = tmp_path / "summary.md"
    monkeypatch.setenv("GITHUB_ACTIONS", "true")
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(summary))
    done = raykiln("batch", plan(folder, ("one", "changed"), defaults=OTHER_SEED), "--local", timeout=300)
    errors = [line for line in done.stdout.splitlines() if line.startswith("::error ")]
    assert len(errors) == 1 and errors[0].startswith("::error title=changed::")
    assert "| changed |" in summary.read_text()


def render(folder, out, seed, *words):
    done = raykiln("render", folder, "-o", out, "--size", "64x48", "--samples", 32, "--seed", seed, "-q", *words)
    assert done.returncode == 0, done.stderr
    return out


def test_compare_tells_noise_from_change(tmp_path):
    same, other = write_scene(tmp_path, "same"), write_scene(tmp_path, "other", grey="0.66 0.66 0.66")
    a, b = render(same, tmp_path / "a.exr", 1), render(same, tmp_path / "b.exr", 2)
    changed = render(other, tmp_path / "c.exr", 3)
    alike = raykiln("compare", a, b, "--json")
    assert alike.returncode == 0, alike.stdout
    verdict = json.loads(alike.stdout)
    assert verdict["noise_considered"] and 0.2 < verdict["noise"]["chi2"] < 1.3
    found = raykiln("compare", changed, b, "--difference", tmp_path / "d.png", "--z-map", tmp_path / "z.png")
    assert found.returncode == 11 and "darker" in found.stdout, found.stdout
    assert (tmp_path / "d.png").stat().st_size > 100 and (tmp_path / "z.png").stat().st_size > 100


def test_compare_without_noise_says_so(tmp_path):
    scene = write_scene(tmp_path, "same")
    exr, png = render(scene, tmp_path / "a.exr", 1), render(scene, tmp_path / "a.png", 1)
    done = raykiln("compare", exr, png)
    assert done.returncode == 0 and "noise was not taken into account" in done.stdout, done.stdout
    small = tmp_path / "small.exr"
    assert raykiln("render", scene, "-o", small, "--size", "16x12", "--samples", 1, "-q").returncode == 0
    sizes = raykiln("compare", exr, small)
    assert sizes.returncode == 11 and "sizes differ" in sizes.stdout
    (tmp_path / "no.exr").write_text("nothing")
    assert raykiln("compare", exr, tmp_path / "no.exr").returncode == 3
    assert raykiln("compare", exr, tmp_path / "absent.exr").returncode == 3
