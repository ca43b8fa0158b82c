"""raykiln, the command line program: what it prints, writes and returns."""

import json
import os
import shutil
import subprocess
import zipfile

import numpy as np
import pytest

from support import scenes
from support.daemon import BIN, ROOT, SLOW
from support.image_files import read_exr, read_png

PROGRAM = str(BIN / "raykiln")


def raykiln(*words, timeout=300.0, **options):
    environment = {k: v for k, v in os.environ.items() if not k.startswith("RAYKILN_")}
    return subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, check=False,
                          timeout=timeout * SLOW, stdin=subprocess.DEVNULL,
                          env=environment, **options)


def lines_of_json(text: str) -> list:
    return [json.loads(line) for line in text.splitlines()]


@pytest.fixture
def folder(tmp_path):
    """A scene as a folder of files."""
    target = tmp_path / "scene"
    target.mkdir()
    for name, content in scenes.box_files("cli").items():
        (target / name).write_text(content)
    return target


@pytest.fixture
def to(api):
    """The option that names the shared daemon."""
    return ("--server", api.daemon.url)


def test_help_names_the_commands_and_exit_codes():
    shown = raykiln("--help")
    assert shown.returncode == 0
    for word in ("render", "submit", "watch", "fetch", "cancel", "scenes", "jobs", "health",
                 "selftest", "lint", "effects", "replay", "compare", "accuracy", "extend", "quote"):
        assert word in shown.stdout, word
    assert "exit" in shown.stdout.lower(), "the exit codes belong to the help"


def test_version():
    shown = raykiln("--version")
    assert shown.returncode == 0 and "0.1.0" in shown.stdout


def test_render_without_a_daemon(folder, tmp_path):
    out = tmp_path / "out.exr"
    done = raykiln("render", folder / "box.obj", "-o", out, "--samples", 4, "--size", "40x30",
                   "--threads", 2, "--seed", 5, "--depth", 3)
    assert done.returncode == 0, done.stderr
    picture = read_exr(out.read_bytes())
    assert (picture.width, picture.height) == (40, 30) and picture.pixels.std() > 0.01


def test_render_writes_png_too_and_reads_zip_and_glb(folder, tmp_path):
    (tmp_path / "box.zip").write_bytes(scenes.box_zip())
    (tmp_path / "one.glb").write_bytes(scenes.triangle_glb())
    for name in ("box.zip", "one.glb"):
        out = tmp_path / f"{name}.png"
        done = raykiln("render", tmp_path / name, "-o", out, "--samples", 1, "--size", "16x12")
        assert done.returncode == 0, done.stderr
        assert read_png(out.read_bytes()).width == 16


def test_render_gives_the_same_bytes_for_any_number_of_threads(folder, tmp_path):
    pictures = []
    for threads in (1, 2, 7):
        out = tmp_path / f"{threads}.exr"
        assert raykiln("render", folder / "box.obj", "-o", out, "--samples", 20, "--size", "70x50",
                       "--threads", threads, "--seed", 1).returncode == 0
        pictures.append(read_exr(out.read_bytes()).pixels)
    assert np.array_equal(pictures[0], pictures[1]) and np.array_equal(pictures[0], pictures[2])


def test_the_daemon_and_the_cli_make_the_same_picture(api, folder, to, tmp_path):
    local, remote = tmp_path / "local.exr", tmp_path / "remote.exr"
    options = ("--samples", 8, "--size", "48x36", "--seed", 9)
    assert raykiln("render", folder / "box.obj", "-o", local, *options).returncode == 0
    submitted = raykiln("submit", folder, *to, *options, "--wait", "--quiet")
    assert submitted.returncode == 0, submitted.stderr
    job = submitted.stdout.split()[-1]
    assert raykiln("fetch", job, *to, "-o", remote).returncode == 0
    one, other = read_exr(local.read_bytes()), read_exr(remote.read_bytes())
    assert np.array_equal(one.pixels, other.pixels)


def test_render_says_where_a_scene_is_wrong(tmp_path):
    (tmp_path / "bad.obj").write_text("v 0 0 0\nv nan 0 0\n")
    done = raykiln("render", tmp_path / "bad.obj", "-o", tmp_path / "x.exr")
    assert done.returncode not in (0, 2) and "bad.obj:2" in done.stderr
    assert not (tmp_path / "x.exr").exists()


def test_wrong_usage_has_a_code_of_its_own(folder, tmp_path):
    codes = {raykiln(*words).returncode for words in (
        ("frobnicate",), ("render",), ("render", folder, "--colour"),
        ("render", folder / "box.obj", "-o", tmp_path / "a.exr", "--samples", "0"),
        ("render", folder / "box.obj", "-o", tmp_path / "a.exr", "--size", "big"),
        ("fetch",))}
    assert len(codes) == 1 and codes != {0}, codes


def test_outcomes_have_different_exit_codes(api, folder, to, tmp_path):
    """Whatever the numbers are, a script can tell these outcomes apart."""
    (tmp_path / "bad.obj").write_text("v nan 0 0\n")
    outcomes = {
        "success": raykiln("jobs", *to),
        "wrong usage": raykiln("frobnicate"),
        "no daemon": raykiln("jobs", "--server", "http://127.0.0.1:1"),
        "refused": raykiln("submit", tmp_path / "bad.obj", *to),
        "not found": raykiln("watch", "j_none", *to),
        "cancelled": cancelled(api, folder, to),
    }
    codes = {name: done.returncode for name, done in outcomes.items()}
    assert codes["success"] == 0
    assert len(set(codes.values())) == len(codes), codes
    shown = raykiln("--help").stdout
    for name, code in codes.items():
        assert str(code) in shown, f"{name}: exit code {code} is not in the help"


def cancelled(api, folder, to):
    job = raykiln("submit", folder, *to, "--size", "512x512", "--samples", 1048576, "--quiet")
    assert job.returncode == 0, job.stderr
    job = job.stdout.split()[-1]
    stopped = raykiln("cancel", job, *to)
    assert stopped.returncode == 0, stopped.stderr
    return raykiln("watch", job, *to)


def test_a_server_s_job_is_told_of_like_one_rendered_here(api, folder, to, tmp_path):
    """Error, interval and what to mind, in the same line, unless --quiet."""
    options = ("--samples", 8, "--size", "24x16")
    here = raykiln("render", folder / "box.obj", "-o", tmp_path / "a.exr", *options).stderr
    there = raykiln("submit", folder, *to, *options, "--wait")
    assert there.returncode == 0, there.stderr
    line = [text for text in here.splitlines() if text.startswith("error ")]
    assert len(line) == 1 and "fewer than 64 samples" in line[0] and "--samples" in line[0], here
    assert line == [text for text in there.stderr.splitlines() if text.startswith("error ")]
    warnings = [text for text in there.stderr.splitlines() if text.startswith("warning: ")]
    assert len(warnings) == len(set(warnings)), "with the upload or with the job, not twice"
    quiet = raykiln("watch", there.stdout.split()[-1], *to, "--quiet")
    assert quiet.returncode == 0 and quiet.stderr == ""


def test_json_output_is_the_contract(api, folder, to):
    submitted = raykiln("submit", folder, *to, "--samples", 2, "--size", "24x16", "--wait", "--json")
    assert submitted.returncode == 0, submitted.stderr
    job = lines_of_json(submitted.stdout)[-1]
    assert job["state"] == "completed"
    watched = lines_of_json(raykiln("watch", job["id"], *to, "--json").stdout)
    assert watched[-1]["state"] == "completed"
    for command, key in (("jobs", "jobs"), ("scenes", "scenes")):
        listed = raykiln(command, *to, "--json")
        assert listed.returncode == 0
        found = lines_of_json(listed.stdout)
        entries = found[0][key] if key in found[0] else found
        assert entries and all("id" in entry for entry in entries)
    problem = raykiln("watch", "j_none", *to, "--json")
    assert "job_not_found" in problem.stdout + problem.stderr


def test_submit_uploads_once(api, folder, to):
    first = raykiln("submit", folder, *to, "--quiet", "--samples", 1, "--size", "8x8")
    count = len(api.json("/v1/scenes", params={"limit": 200})["scenes"])
    second = raykiln("submit", folder, *to, "--quiet", "--samples", 1, "--size", "8x8")
    assert first.returncode == second.returncode == 0 and first.stdout != second.stdout
    assert len(api.json("/v1/scenes", params={"limit": 200})["scenes"]) == count


def test_fetch_writes_nothing_on_failure(api, to, tmp_path):
    out = tmp_path / "none.png"
    done = raykiln("fetch", "j_none", *to, "-o", out)
    assert done.returncode != 0 and not out.exists() and "j_none" in done.stderr


def test_an_output_that_cannot_be_written(folder, tmp_path):
    done = raykiln("render", folder / "box.obj", "-o", tmp_path / "no" / "dir" / "a.exr",
                   "--samples", 1, "--size", "8x8")
    assert done.returncode != 0 and "a.exr" in done.stderr


def test_no_progress_bar_without_a_terminal(folder, tmp_path):
    done = raykiln("render", folder / "box.obj", "-o", tmp_path / "a.exr", "--samples", 1,
                   "--size", "8x8")
    assert "\r" not in done.stdout + done.stderr and "\033" not in done.stdout + done.stderr


def test_the_bundled_demo_renders(tmp_path):
    demo = ROOT / "server" / "app" / "demo"
    out = tmp_path / "demo.exr"
    done = raykiln("render", demo / "demo.obj", "-o", out, "--samples", 4, "--size", "64x48")
    assert done.returncode == 0, done.stderr
    picture = read_exr(out.read_bytes())
    assert np.isfinite(picture.pixels).all() and picture.pixels.std() > 0.01
    assert "warning" not in done.stderr.lower(), done.stderr


def test_health(api, to):
    assert raykiln("health", *to).returncode == 0
    assert raykiln("health", "--server", "http://127.0.0.1:1").returncode != 0


def test_a_zip_made_by_others(api, to, tmp_path):
    """Debian's zip and Python's differ in flags; both must be read."""
    path = tmp_path / "by-zip.zip"
    for name, content in scenes.box_files("zip").items():
        (tmp_path / name).write_text(content)
    subprocess.run(["zip", "-q", str(path), *scenes.box_files()], cwd=tmp_path, check=True)
    assert zipfile.ZipFile(path).namelist()
    done = raykiln("submit", path, *to, "--samples", 1, "--size", "8x8", "--wait")
    assert done.returncode == 0, done.stderr


@pytest.mark.one_thread
def test_selftest_passes_on_this_binary():
    done = raykiln("selftest", "--json", timeout=1800)
    report = json.loads(done.stdout)
    failed = [row for row in report["rows"] if not row["passed"]]
    assert done.returncode == 0 and report["failed"] == 0, failed
    assert report["checks"] == len(report["rows"]) >= 20
    assert {"T03", "T14", "V03", "X01", "X03"} <= {row["id"] for row in report["rows"]}


def test_effects_says_what_is_simulated_and_why(folder, tmp_path):
    report = json.loads(raykiln("effects", folder / "box.obj", "--json").stdout)
    verdicts = {line["effect"]: line for line in report["list"]}
    assert report["label"] == "auto" and all(line["evidence"] for line in report["list"])
    assert verdicts["diffuse_reflection"]["simulated"]
    assert verdicts["refraction"]["grade"] == "identical" and verdicts["refraction"]["left_out"]
    assert "diffuse_reflection" in raykiln("effects", folder / "box.obj").stdout
    assert raykiln("effects", folder / "box.obj", "--effects", "without=moire").returncode == 2

    words = ("--size", "16x12", "--samples", 2)
    pictures = [tmp_path / name for name in ("auto.png", "all.png", "draft.png")]
    for picture, choice in zip(pictures, ("auto", "all", "without=diffuse_reflection")):
        done = raykiln("render", folder / "box.obj", "-o", picture, "--effects", choice, *words)
        assert done.returncode == 0, done.stderr
    assert "lacks what the scene calls for, on request: diffuse_reflection" in done.stderr
    same, also, draft = (picture.read_bytes() for picture in pictures)
    assert same == also and draft != same
    assert b"Deliberate approximation" in draft and b"Deliberate" not in same


def test_lint_of_a_sound_scene(folder):
    done = raykiln("lint", folder / "box.obj", "--json")
    report = json.loads(done.stdout)
    assert done.returncode == 0 and report["errors"] == 0, report


def test_lint_reports_open_glass_and_what_is_missing(tmp_path):
    (tmp_path / "glass.mtl").write_text(
        "newmtl glass\nKs 1 1 1\nTf 1 1 1\nd 0\nNi 1.5\nNs 1000\nillum 7\n")
    (tmp_path / "pane.obj").write_text(
        "mtllib glass.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl glass\nf 1 2 3\n")
    done = raykiln("lint", tmp_path / "pane.obj", "--json")
    report = json.loads(done.stdout)
    assert done.returncode == 10
    assert "open_glass" in [f["code"] for f in report["findings"] if f["level"] == "error"]
    gone = raykiln("lint", tmp_path / "gone.obj", "--json")
    assert gone.returncode == 10 and json.loads(gone.stdout)["findings"][0]["code"] == "file_missing"


def test_lint_of_a_refused_scene_names_the_place(tmp_path):
    (tmp_path / "bad.obj").write_text("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n")
    done = raykiln("lint", tmp_path / "bad.obj")
    assert done.returncode == 10 and "line 2" in done.stdout and "error" in done.stdout


def test_half_floats_take_half_the_bytes_and_say_what_they_clamp(folder, tmp_path):
    sidecar = json.loads((folder / "raykiln.json").read_text())
    sidecar["background"] = [1e6, 1e6, 1e6]
    bright = tmp_path / "bright"
    shutil.copytree(folder, bright)
    (bright / "raykiln.json").write_text(json.dumps(sidecar))
    whole, half = tmp_path / "whole.exr", tmp_path / "half.exr"
    words = ("render", bright / "box.obj", "--samples", 1, "--size", "32x24")
    assert raykiln(*words, "-o", whole).returncode == 0
    done = raykiln(*words, "-o", half, "--half")
    assert done.returncode == 0
    full, cut = read_exr(whole.read_bytes()), read_exr(half.read_bytes())
    beyond = int((full.pixels > 65504).sum())
    assert f"{beyond} values are beyond 65504" in done.stderr
    assert cut.metadata["raykiln:clamped_values"] == str(beyond)
    assert np.isfinite(cut.pixels).all() and cut.pixels.max() == 65504
    inside = (full.pixels < 65504) & (full.pixels > 1e-3)
    assert np.allclose(cut.pixels[inside], full.pixels[inside], rtol=2**-11)


def test_replay_gives_the_same_sample_again(folder, tmp_path):
    words = ("--size", "8x6", "--seed", 5)
    out = tmp_path / "one.exr"
    assert raykiln("render", folder / "box.obj", "-o", out, "--samples", 1, *words).returncode == 0
    picture = read_exr(out.read_bytes())
    done = raykiln("replay", folder / "box.obj", 3, 4, 0, "--json", *words)
    assert done.returncode == 0, done.stderr
    sample = json.loads(done.stdout)
    assert not sample["dropped"]
    assert np.allclose(picture.pixels[4, 3], sample["radiance"], rtol=1e-6)
    assert raykiln("replay", folder / "box.obj", 8, 0, 0, *words).returncode == 2


def test_accuracy_measures_every_knob_and_judges_its_own_reference(folder, tmp_path):
    page, table = tmp_path / "knobs.html", tmp_path / "knobs.csv"
    done = raykiln("accuracy", folder, "--size", "16x12", "--seconds", 0.02, "--reference-seconds", 4,
                   "--html", page, "--csv", table, "--json", timeout=600)
    report = json.loads(done.stdout)
    assert done.returncode == (0 if report["reference"]["exact_enough"] else 12), done.stderr
    knobs = {line["knob"]: line for line in report["knobs"]}
    assert {"defaults", "diffuse=uniform", "light_model=seed", "effects=all"} <= set(knobs)
    assert not knobs["defaults"]["bias"]["certain"]
    points = knobs["defaults"]["points"]
    assert [p["samples"] for p in points] == [2 << i for i in range(len(points))]
    assert report["reference"]["error"] > 0 and all(p["error"] > 0 for p in points)
    assert len(table.read_text().splitlines()) == 1 + sum(len(line["points"]) for line in report["knobs"])
    text = page.read_text()
    assert "<svg" in text and "http" not in text and all(f">{name}<" in text for name in knobs)


def test_accuracy_refuses_what_would_take_for_ever(folder):
    assert raykiln("accuracy", folder, "--size", "1000x1000").returncode == 2
    assert raykiln("accuracy", folder / "none.obj").returncode == 3


def test_a_quote_is_bought_by_extending_it(api, to, folder, tmp_path):
    for seconds in (0.3, 2, 10, 50):  # until a busy machine has had the time to learn something
        done = raykiln("quote", folder, *to, "--size", "16x12", "--pilot-seconds", seconds)
        assert done.returncode == 0, done.stderr
        if "error 1 %" in done.stdout:
            break
    assert "error 1 %" in done.stdout and "raykiln extend" in done.stdout
    quote = json.loads(raykiln("quote", folder, *to, "--size", "16x12", "--pilot-seconds", 0.2, "--json").stdout)
    more = int(quote["pilot"]["samples"]) + 100
    picture, whole = tmp_path / "more.png", tmp_path / "whole.png"
    assert raykiln("extend", quote["id"], *to, "--samples", more, "-o", picture).returncode == 0
    assert raykiln("render", folder, "--size", "16x12", "--samples", more, "-o", whole).returncode == 0
    assert picture.read_bytes() == whole.read_bytes()
    assert raykiln("extend", quote["id"], *to).returncode == 2
    assert raykiln("extend", "j_none", *to, "--samples", 4).returncode == 8
