"""The compared scenes, as files that raykiln reads. Nothing here knows the other renderer.

Lamps are closed bodies, or lie flush in a hole of a ceiling: emitters of raykiln shine from both
sides, those of Mitsuba from one. Surfaces are flat facets, so that no interpolated normal, for which
programs have different remedies, takes part.
"""

from pathlib import Path

import numpy as np

import scene_files
from shapes import Mesh, box, lamp_in_ceiling, quad, room, sphere

FRONT = {"eye": [0, 1, 4.1], "look_at": [0, 1, 0], "fov_deg": 35.6}
LAMBERT = {"KHR_materials_specular": {"specularFactor": 0}}
ROOM_MTL = {
    "white": ["Kd 0.73 0.71 0.68"], "left": ["Kd 0.63 0.06 0.05"], "right": ["Kd 0.12 0.45 0.15"],
    "lamp": ["Kd 0 0 0", "Ke 17 12 5"],
}


def matte(r, g, b, **more) -> dict:
    """Lambert's surface: a glTF material whose facets reflect nothing."""
    return {"pbrMetallicRoughness": {"baseColorFactor": [r, g, b, 1], "metallicFactor": 0,
                                     "roughnessFactor": 1}, "extensions": LAMBERT, **more}


def glowing(r, g, b, strength=1.0) -> dict:
    top = max(r, g, b)
    return matte(0, 0, 0, emissiveFactor=[r / top, g / top, b / top]) | {"extensions": {
        **LAMBERT, "KHR_materials_emissive_strength": {"emissiveStrength": top * strength}}}


ROOM_GLTF = {"white": matte(0.73, 0.71, 0.68), "left": matte(0.63, 0.06, 0.05),
             "right": matte(0.12, 0.45, 0.15), "lamp": glowing(17, 12, 5)}


def lit_room() -> list:
    return room() + [lamp_in_ceiling(0.25, 2.0, "lamp")]


def cornell(folder: Path):
    blocks = [box((-0.33, 0.6, -0.3), (0.3, 0.6, 0.3), "white", 18),
              box((0.36, 0.3, 0.35), (0.3, 0.3, 0.3), "white", -17)]
    scene_files.write_obj(folder, lit_room() + blocks, ROOM_MTL, {"camera": FRONT, "background": [0, 0, 0]})


def glass_and_mirror(folder: Path):
    balls = [sphere((-0.45, 0.4, -0.3), 0.4, "mirror"), sphere((0.45, 0.45, 0.3), 0.4, "glass")]
    sidecar = {"camera": FRONT, "background": [0, 0, 0], "materials": {
        "mirror": {"diffuse": [0, 0, 0], "specular": [0.95, 0.9, 0.85], "specular_exp": 1e15},
        "glass": {"diffuse": [0, 0, 0], "specular": [1, 1, 1], "transparent": 1,
                  "specular_exp": 1e15, "index_of_refraction": 1.5}}}
    materials = {**ROOM_MTL, "mirror": ["Kd 0 0 0"], "glass": ["Kd 0 0 0"]}
    scene_files.write_obj(folder, lit_room() + balls, materials, sidecar)


def on_table(folder, name, material, background=(0.25, 0.3, 0.4), **files):
    """A ball on an open table below a lamp that is a closed body."""
    meshes = [quad((-4, 0, 4), (8, 0, 0), (0, 0, -8), "table"),
              sphere((0, 0.75, 0), 0.75, name, 3), box((-1.6, 2.6, 1.2), (0.4, 0.1, 0.4), "lamp", 30)]
    materials = {"table": matte(0.5, 0.4, 0.3), "lamp": glowing(18, 17, 15), name: material}
    camera = {"eye": [0.4, 1.6, 4.0], "look_at": [0, 0.7, 0], "fov_deg": 36}
    scene_files.write_gltf(folder, meshes, materials, {"camera": camera, "background": background}, **files)


def metal(roughness):
    def write(folder: Path):
        on_table(folder, "metal", {"pbrMetallicRoughness": {
            "baseColorFactor": [0.95, 0.7, 0.3, 1], "metallicFactor": 1, "roughnessFactor": roughness}})
    return write


def plastic(folder: Path):
    on_table(folder, "plastic", {"pbrMetallicRoughness": {
        "baseColorFactor": [0.2, 0.5, 0.8, 1], "metallicFactor": 0, "roughnessFactor": 0.4}})


def glass_body(roughness, attenuation=None):
    def write(folder: Path):
        volume = {"thicknessFactor": 1}
        if attenuation:
            volume |= {"attenuationColor": attenuation, "attenuationDistance": 0.8}
        on_table(folder, "glass", {
            "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 1], "metallicFactor": 0,
                                     "roughnessFactor": roughness},
            "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1},
                           "KHR_materials_ior": {"ior": 1.5}, "KHR_materials_volume": volume}})
    return write


def write_png(path: Path, pixels):
    import mitsuba as mi
    mi.Bitmap(np.ascontiguousarray(pixels, np.uint8)).write(str(path))


def textured(folder: Path):
    rng = np.random.default_rng(7)
    write_png(folder / "base.png", rng.integers(20, 236, (12, 16, 3)))
    glow = rng.integers(0, 256, (6, 4, 3))
    glow[0] = 0
    write_png(folder / "glow.png", glow)
    place = {"KHR_texture_transform": {"offset": [0.13, -0.2], "rotation": 0.4, "scale": [2.5, 1.7]}}
    materials = {
        "wall": matte(0.9, 0.8, 0.7), "table": matte(0.5, 0.5, 0.5),
        "panel": {**glowing(1, 1, 1, 6), "emissiveTexture": {"index": 1}}}
    materials["wall"]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0, "extensions": place}
    meshes = [quad((-1.5, 0, -1), (3, 0, 0), (0, 2.2, 0), "wall", uvs=True),
              quad((-1.5, 0, 1), (3, 0, 0), (0, 0, -2), "table"),
              quad((1.5, 0.2, -0.7), (0, 0, 1.4), (0, 1.6, 0), "panel", uvs=True)]  # faces -x
    sampler = {"magFilter": 9729, "wrapS": 33648, "wrapT": 33648}
    scene_files.write_gltf(folder, meshes, materials, {
        "camera": {"eye": [-0.3, 1.0, 4.2], "look_at": [0, 1, 0], "fov_deg": 36},
        "background": [0.1, 0.1, 0.1]},
        textures=[("base.png", sampler), ("glow.png", {"wrapS": 33071, "wrapT": 33071})])


def sky(directions) -> np.ndarray:
    """Radiance of a smooth sky with a broad sun and a dim ground."""
    sun = np.array([0.5, 0.6, 0.62])
    glow = np.exp(-30 * (1 - directions @ (sun / np.linalg.norm(sun))))[..., None]
    up = directions[..., 1:2]
    return np.array([0.3, 0.5, 0.9]) * (0.6 + 0.4 * up) + 12 * glow * np.array([1, 0.8, 0.5])


def environment(folder: Path):
    import mitsuba as mi
    height, width = 128, 256
    theta = (np.arange(height) + 0.5)[:, None] / height * np.pi
    phi = ((np.arange(width) + 0.5)[None, :] / width - 0.5) * 2 * np.pi
    # Middle of a row: -z; right of it: +x.
    directions = np.stack(np.broadcast_arrays(np.sin(theta) * np.sin(phi), np.cos(theta),
                                              -np.sin(theta) * np.cos(phi)), -1)
    mi.Bitmap(sky(directions).astype(np.float32)).write(str(folder / "sky.exr"))
    meshes = [quad((-2, 0, 2), (4, 0, 0), (0, 0, -4), "table"), sphere((-0.7, 0.6, 0), 0.6, "matte", 2),
              sphere((0.7, 0.6, 0.2), 0.6, "mirror")]
    materials = {"table": ["Kd 0.5 0.4 0.3"], "matte": ["Kd 0.7 0.7 0.7"], "mirror": ["Kd 0 0 0"]}
    scene_files.write_obj(folder, meshes, materials, {
        "camera": {"eye": [0, 1.3, 4.2], "look_at": [0, 0.5, 0], "fov_deg": 36},
        "environment": {"file": "sky.exr", "rotation_degrees": 70, "scale": 0.8},
        "materials": {"mirror": {"diffuse": [0, 0, 0], "specular": [0.9, 0.9, 0.9], "specular_exp": 1e15}}})


def many_emitters(folder: Path, kinds=10):
    """Closed bodies of four triangles, 25 of each kind, of powers over three decades: 100 emitters a kind."""
    rng = np.random.default_rng(11)
    meshes, materials = room(lamp=0), dict(ROOM_MTL)
    del materials["lamp"]
    corners = 0.004 * np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])  # outwards
    for k in range(kinds):
        radiance = 300 * 10 ** (-3 * k / (kinds - 1)) * rng.uniform(0.3, 1.0, 3)
        materials[f"bulb{k}"] = ["Kd 0 0 0", "Ke " + " ".join(f"{x:.6g}" for x in radiance)]
        centres = rng.uniform((-0.9, 1.5, -0.9), (0.9, 1.9, 0.9), (25, 3))
        meshes.append(Mesh((centres[:, None] + corners).reshape(-1, 3),
                           (4 * np.arange(25)[:, None, None] + faces).reshape(-1, 3), f"bulb{k}"))
    scene_files.write_obj(folder, meshes, materials, {"camera": FRONT, "background": [0, 0, 0]})


def punctual(folder: Path):
    meshes = room(lamp=0) + [box((0.3, 0.4, 0), (0.3, 0.4, 0.3), "white", 25)]
    materials = {k: v for k, v in ROOM_GLTF.items() if k != "lamp"}
    lights = [({"type": "point", "color": [1, 0.8, 0.6], "intensity": 2}, {"translation": [-0.5, 1.6, 0.3]}),
              # Turned about x by -45 degrees: shines down and backwards.
              ({"type": "directional", "color": [0.6, 0.8, 1], "intensity": 1.5},
               {"rotation": [-np.sin(np.pi / 8), 0, 0, np.cos(np.pi / 8)]})]
    scene_files.write_gltf(folder, meshes, materials, {"camera": FRONT, "background": [0, 0, 0]}, lights=lights)


def half_covered(folder: Path):
    material = matte(0.2, 0.6, 0.2, alphaMode="BLEND", doubleSided=True)  # its inside shows
    material["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.4
    on_table(folder, "veil", material)


def foliage(folder: Path):
    """Crossed leaves whose outlines are the alpha of their texture, cut at 0.5."""
    y, x = (np.mgrid[0:32, 0:32] + 0.5) / 16 - 1
    alpha = np.where(x**2 + (y * 0.6) ** 2 < 0.55 + 0.2 * np.sin(9 * y), 255, 0)
    green = np.stack([60 + 40 * y, 150 + 50 * x, 40 + 0 * x], -1)
    write_png(folder / "leaf.png", np.dstack([green, alpha]))
    rng = np.random.default_rng(3)
    meshes = [quad((-3, 0, 3), (6, 0, 0), (0, 0, -6), "table"),
              box((-1.6, 2.6, 1.2), (0.4, 0.1, 0.4), "lamp", 30)]
    for _ in range(40):
        u, v = (w / np.linalg.norm(w) * 0.5 for w in rng.normal(size=(2, 3)))
        meshes.append(quad(rng.uniform((-1, 0.6, -1), (1, 1.8, 1)), u, v, "leaf", uvs=True))
    leaf = matte(1, 1, 1, alphaMode="MASK", alphaCutoff=0.5, doubleSided=True)
    leaf["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    materials = {"table": matte(0.5, 0.4, 0.3), "lamp": glowing(30, 28, 25), "leaf": leaf}
    # Nearest texels: the outline is the same squares in any program.
    scene_files.write_gltf(folder, meshes, materials, {
        "camera": {"eye": [0, 1.6, 4.2], "look_at": [0, 1, 0], "fov_deg": 36},
        "background": [0.3, 0.35, 0.45]}, textures=[("leaf.png", {"magFilter": 9728, "minFilter": 9728})])


def thin_lens(folder: Path):
    balls = [sphere((x, 0.3, z), 0.3, "white", 2) for x, z in ((-0.6, -0.6), (0, 0.1), (0.5, 0.8))]
    camera = {**FRONT, "lens_radius": 0.12, "focus_distance": 4.0}
    scene_files.write_obj(folder, lit_room() + balls, ROOM_MTL, {"camera": camera, "background": [0, 0, 0]})
