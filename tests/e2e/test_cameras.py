"""Cameras by name, lenses, crop windows and the settings of sampling beside them, from the upload to the picture."""

import json

import numpy as np

from support import scenes
from support.image_files import read_exr

# A white square of side 2 at z = 0 that shines at 1; from 4 m above it a view of height 4 has it in its middle half.
OBJ = "mtllib s.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nusemtl glow\nf 1 2 3 4\n"
MTL = "newmtl glow\nKd 0 0 0\nKe 1 1 1\nillum 1\n"
ABOVE = {"eye": [0, 0, 4], "look_at": [0, 0, 0]}
CAMERAS = [{"name": "angle", **ABOVE, "fov_deg": 60}, {"name": "plan", **ABOVE, "view_height": 4},
           {"name": "soft", **ABOVE, "fov_deg": 60, "lens_radius": 0.5, "focus_distance": 1}]


def picture(api, scene, side=32, **fields):
    fields = {"width": side, "height": side, "stop": {"samples": 16}, **fields}
    final = api.wait(api.job(scene, **fields))
    assert final["state"] == "completed", final["error"]
    exr = read_exr(api.image(final["id"], "exr").content)
    return exr.pixels[..., exr.channels.index("G")], final


def upload(api):
    document = {"cameras": CAMERAS, "background": [0, 0, 0]}
    return api.scene(scenes.zip_of({"s.obj": OBJ, "s.mtl": MTL, "raykiln.json": json.dumps(document)}))


def test_cameras_by_name_and_a_plan_view(api):
    scene = upload(api)
    assert [c["name"] for c in api.json(f"/v1/scenes/{scene}")["cameras"]] == ["angle", "plan", "soft"]
    inside = np.zeros((32, 32))
    inside[8:24, 8:24] = 1
    plan, _ = picture(api, scene, camera="plan")
    assert (plan == inside).all()
    own, job = picture(api, scene, camera={**ABOVE, "view_height": 4})
    assert (own == plan).all() and job["request"]["camera"]["view_height"] == 4
    angle, _ = picture(api, scene, camera="angle")
    share = (1 / (4 * np.tan(np.pi / 6))) ** 2
    assert abs(angle.mean() - share) < 0.02 and not (angle == plan).all()


def test_a_lens_blurs_what_is_out_of_focus_and_only_that(api):
    scene = upload(api)
    soft, job = picture(api, scene, camera="soft")
    effects = {line["effect"]: line for line in job["effects"]["list"]}
    assert effects["depth_of_field"]["simulated"]
    sharp, _ = picture(api, scene, camera="angle")
    assert ((soft > 0) & (soft < 1)).sum() > 2 * ((sharp > 0) & (sharp < 1)).sum()
    without, job = picture(api, scene, camera="soft", effects={"without": ["depth_of_field"]})
    assert (without == sharp).all() and "deliberate_approximation" in [w["code"] for w in job["warnings"]]
    given, job = picture(api, scene, camera="angle", lens={"radius": 0.5, "focus_distance": 1})
    assert (given == soft).all() and job["request"]["lens"] == {"radius": 0.5, "focus_distance": 1}
    taken, _ = picture(api, scene, camera="soft", lens={"radius": 0})
    assert (taken == sharp).all()


def test_a_crop_window_is_a_piece_of_the_picture(api):
    scene = upload(api)
    fields = {"camera": "soft", "filter": "blackman_harris", "emitter_choice": "tree"}
    whole, _ = picture(api, scene, **fields)
    crop = {"x": 5, "y": 9, "full_width": 32, "full_height": 32}
    part, job = picture(api, scene, width=20, height=7, crop=crop, **fields)
    assert (part == whole[9:16, 5:25]).all() and job["request"]["crop"] == crop
    box, _ = picture(api, scene, camera="soft")
    assert not (box == whole).all()


def test_what_cannot_be_is_refused_with_its_place(api):
    scene = upload(api)
    for where, fields in [("/camera", {"camera": "top"}),
                          ("/lens/focus_distance", {"lens": {"radius": 1}}),
                          ("/crop/x", {"crop": {"x": 1, "y": 0, "full_width": 32, "full_height": 32}}),
                          ("/filter", {"filter": "blackman_harris", "pixel_mode": "centre"}),
                          ("/texture_filter", {"texture_filter": "best"}),
                          ("/emitter_choice", {"emitter_choice": "best"})]:
        answer = api.submit(scene, expect=(400, 422), width=32, height=32, stop={"samples": 1}, **fields)
        assert where in answer.text, answer.text
