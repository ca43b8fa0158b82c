"""`tree`: what the kd-tree of a job's scene may take. It costs time, never a pixel."""

import random

import numpy as np

from support import scenes
from support.api import problem
from support.image_files import read_exr
from test_batches import wait as wait_for_batch
from test_cli import raykiln
from test_reuse import counter

TRIANGLES = 400


def hair_obj() -> bytes:
    """Long thin triangles through one another, for which the tree takes all references it may."""
    numbers = random.Random(3)
    lines = []
    for _ in range(TRIANGLES):
        x, y, z = (numbers.uniform(-1, 1) for _ in range(3))
        dx, dy, dz = (numbers.uniform(-1, 1) for _ in range(3))
        lines += [f"v {x} {y} {z}", f"v {x + dx} {y + dy} {z + dz}", f"v {x + dx} {y + dy + 0.02} {z + dz}"]
    lines += [f"f {3 * i + 1} {3 * i + 2} {3 * i + 3}" for i in range(TRIANGLES)]
    return ("\n".join(lines) + "\n").encode()


def hair(tag="") -> bytes:
    return scenes.zip_of({"hair.obj": hair_obj(), "raykiln.json": scenes.json.dumps(scenes.SIDECAR), "tag.txt": tag})


def rendered(api, scene, **fields):
    done = api.wait(api.job(scene, **fields))
    assert done["state"] == "completed", done["error"]
    return done, read_exr(api.image(done["id"], "exr").content).pixels


def test_any_budget_gives_the_same_picture_of_one_import(launch):
    api = launch()
    scene = api.scene(hair())
    usual, expected = rendered(api, scene)
    assert usual["request"]["tree"] == {"references_per_triangle": 4}
    figures = usual["statistics"]
    assert TRIANGLES < figures["tree_references"] <= 4 * TRIANGLES
    assert 0 < figures["tree_bytes"] <= figures["tree_peak_bytes"]
    least = figures["tree_peak_bytes"]
    for tree in ({"references_per_triangle": 1}, {"references_per_triangle": 2}, {"max_bytes": 10 * least},
                 {"references_per_triangle": 1.5, "max_bytes": 10 * least}):
        done, picture = rendered(api, scene, tree=tree)
        assert np.array_equal(picture, expected), tree
        assert done["request"]["tree"] == {"references_per_triangle": 4, **tree}
        most = tree.get("references_per_triangle", 4)
        assert done["statistics"]["tree_references"] <= most * TRIANGLES
        assert most == 4 or done["statistics"]["tree_budget_reached"] is True
    assert api.json(f"/v1/scenes/{scene}")["tree"]["references"] <= 1.5 * TRIANGLES, "the last one"
    assert counter(api, "raykiln_tree_builds_total") == 4, "so many bytes come to the usual tree"
    assert counter(api, "raykiln_scene_imports_total") == 1


def test_too_few_bytes_fail_the_job_and_say_how_many_are_needed(api):
    scene = api.scene(hair("few"))
    failed = api.wait(api.job(scene, tree={"max_bytes": 1}))
    assert failed["state"] == "failed" and failed["image"] is None
    error = failed["error"]
    assert (error["status"], error["code"], error["where"]) == (422, "tree_too_large", "/tree/max_bytes")
    needed = int(error["detail"].split("allow ")[1].split(" or more")[0])
    done, _ = rendered(api, scene, tree={"max_bytes": needed})
    assert done["statistics"]["tree_peak_bytes"] <= needed
    assert api.wait(api.job(scene, tree={"max_bytes": needed - 1}))["error"]["code"] == "tree_too_large"


def test_nonsense_is_refused_with_its_place(api, samples):
    for where, tree in [("/tree", 4), ("/tree/references_per_triangle", {"references_per_triangle": 0.5}),
                        ("/tree/references_per_triangle", {"references_per_triangle": 65}),
                        ("/tree/max_bytes", {"max_bytes": 0}), ("/tree/max_bytes", {"max_bytes": "1GB"}),
                        ("/tree/bytes", {"bytes": 1000})]:
        refused = problem(api.submit(samples["box"], expect=(422,), tree=tree), 422, "invalid_request")
        assert [error["pointer"] for error in refused["errors"]] == [where]


def test_quotes_extensions_batches_and_restarts_keep_it(launch):
    api = launch()
    scene = api.scene(hair())
    tree = {"references_per_triangle": 1.5, "max_bytes": 50_000_000}
    body = {"scene": scene, "width": 32, "height": 24, "tree": tree, "pilot_seconds": 0.1}
    pilot = api.post("/v1/quotes", body).json()["id"]
    assert api.wait(pilot)["request"]["tree"] == tree
    longer = api.post(f"/v1/jobs/{pilot}/extend", {"stop": {"samples": 1_000_000}}).json()["id"]
    assert api.state(longer)["request"]["tree"] == tree
    settings = [{"width": 32, "height": 24, "stop": {"samples": 4}, "tree": tree, "name": "narrow"},
                {"width": 32, "height": 24, "stop": {"samples": 4}, "tree": {"max_bytes": 1}, "name": "none"}]
    batch = api.post("/v1/batches", {"scenes": [{"scene": scene, "name": "hair", "settings": settings}]}).json()["id"]
    api.wait_until(longer, lambda job: job["state"] == "rendering")
    assert api.daemon.stop() == 0
    api.daemon.start()
    again = api.wait_until(longer, lambda job: job["state"] == "rendering")
    assert again["request"]["tree"] == tree and again["statistics"]["tree_references"] <= 1.5 * TRIANGLES
    api.cancel(longer)
    items = wait_for_batch(api, batch)["items"]
    assert [item["state"] for item in items] == ["completed", "failed"], items
    assert items[1]["error"]["code"] == "tree_too_large"
    assert api.state(items[0]["job"])["request"]["tree"] == tree


def test_the_command_line_bounds_trees_too(api, tmp_path):
    scene = tmp_path / "hair.zip"
    scene.write_bytes(hair())
    options = ("--samples", 4, "--size", "32x24", "--quiet")
    pictures = []
    for name, more in [("usual", ()), ("one", ("--tree-references", 1)), ("bytes", ("--tree-bytes", "1MB"))]:
        out = tmp_path / f"{name}.exr"
        done = raykiln("render", scene, "-o", out, *options, *more)
        assert done.returncode == 0, done.stderr
        pictures.append(read_exr(out.read_bytes()).pixels)
    assert all(np.array_equal(picture, pictures[0]) for picture in pictures)
    told = raykiln("render", scene, "-o", tmp_path / "told.exr", *options[:-1], "--tree-references", 1).stderr
    assert f"tree: {TRIANGLES} references" in told and "the picture is exact" in told
    few = raykiln("render", scene, "-o", tmp_path / "few.exr", *options, "--tree-bytes", 100)
    assert few.returncode == 4 and "tree_too_large" in few.stderr and "or more" in few.stderr
    assert not (tmp_path / "few.exr").exists()
    for wrong in (("--tree-references", 0.5), ("--tree-references", 65), ("--tree-bytes", 0), ("--tree-bytes", "x")):
        assert raykiln("render", scene, "-o", tmp_path / "wrong.exr", *options, *wrong).returncode == 2
    sent = raykiln("submit", scene, "--server", api.daemon.url, *options, "--wait", "--tree-bytes", 100)
    assert sent.returncode == 4 and "tree_too_large" in sent.stderr
    job = raykiln("submit", scene, "--server", api.daemon.url, *options, "--tree-references", 2, "--tree-bytes", "10MB")
    asked = api.state(job.stdout.split()[-1])["request"]["tree"]
    assert asked == {"references_per_triangle": 2, "max_bytes": 10_000_000}
    assert "--tree-bytes" in raykiln("render", "--help").stdout
