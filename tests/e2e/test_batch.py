"""raykiln compare, batch and approve: verdicts, reports and exit codes."""

import json
import shutil
import subprocess
import xml.etree.ElementTree as ET

import jsonschema
import pytest
import yaml

from support import scenes
from support.daemon import ROOT, SLOW
from test_cli import raykiln

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
    """The structure that CI systems read: suites of suites of cases with counts that add up."""
    root = ET.parse(path).getroot()
    assert root.tag == "testsuites"
    (suite,) = root
    assert {k: int(suite.get(k)) for k in ("tests", "failures", "errors", "skipped")} == counts
    assert float(suite.get("time")) >= 0
    cases = list(suite)
    assert len(cases) == counts["tests"]
    for case in cases:
        assert case.tag == "testcase" and case.get("name") and case.get("classname")
        assert float(case.get("time")) >= 0
        kinds = [child.tag for child in case]
        assert set(kinds) <= {"failure", "error", "skipped", "system-out"} and kinds[-1] == "system-out"
    for tag, key in (("failure", "failures"), ("error", "errors"), ("skipped", "skipped")):
        assert len(suite.findall(f"testcase/{tag}")) == counts[key]


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


def test_six_scenes_one_broken_one_changed(gallery, tmp_path):
    folder = copy(gallery, tmp_path)
    done, report = run(plan(folder, defaults=OTHER_SEED), "--local")
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


def test_exit_codes_follow_the_gravest_outcome(gallery, tmp_path):
    folder = copy(gallery, tmp_path)
    assert run(plan(folder, ("one", "two"), defaults=OTHER_SEED), "--local")[0].returncode == 0
    assert run(plan(folder, ("one", "changed"), defaults=OTHER_SEED), "--local")[0].returncode == 11
    assert run(plan(folder, ("changed", "broken"), defaults=OTHER_SEED), "--local")[0].returncode == 4
    assert raykiln("batch", folder / "none.yaml", "--local").returncode == 3
    (folder / "bad.yaml").write_text("scenes: [{scene: a.obj, colour: red}]")
    bad = raykiln("batch", folder / "bad.yaml", "--local")
    assert bad.returncode == 2 and "colour" in bad.stderr and "line 1" in bad.stderr


def test_fail_fast_skips_the_rest(gallery, tmp_path):
    folder = copy(gallery, tmp_path)
    done, report = run(plan(folder, ("broken", "one", "two"), fail_fast=True), "--local")
    assert done.returncode == 4
    assert verdicts(report) == {"broken": "failed", "one": "skipped", "two": "skipped"}
    check_junit(folder / "junit.xml", {"tests": 3, "failures": 0, "errors": 1, "skipped": 2})


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
    done = raykiln("batch", plan(folder, ("one", "changed"), defaults=OTHER_SEED), "--local", timeout=120)
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
