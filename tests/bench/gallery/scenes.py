"""The gallery's scenes, written as files into a folder: glTF, pictures and raykiln.json."""

import json
import math

import numpy as np

from shapes import Gltf, box, hdr, joined, png, quad, sphere

GOLD, COPPER, SILVER = (1.0, 0.77, 0.34), (0.95, 0.64, 0.54), (0.97, 0.96, 0.92)


def metals(folder):
    """Metals of four roughnesses and painted spheres on tiles, under a sky with a low sun."""
    scene = Gltf()
    (folder / "tiles.png").write_bytes(png(tiles()))
    (folder / "sky.hdr").write_bytes(hdr(sky()))
    floor = scene.material(pbrMetallicRoughness={
        "baseColorTexture": scene.texture("tiles.png"), "metallicFactor": 0, "roughnessFactor": 0.35})
    scene.add(quad((-200, 0, 200), (400, 0, 0), (0, 0, -400), 200), floor)
    for i, roughness in enumerate((0.05, 0.2, 0.4, 0.7)):
        for row, colour in enumerate((GOLD, SILVER)):
            metal = scene.material(pbrMetallicRoughness=lobe(colour, 1, roughness))
            scene.add(sphere((2.3 * (i - 1.5), 1, -2.4 * row), 1), metal)
    for i, colour in enumerate(((0.7, 0.06, 0.05), (0.05, 0.3, 0.5), (0.08, 0.4, 0.1))):
        paint = scene.material(pbrMetallicRoughness=lobe(colour, 0, 0.15))
        scene.add(sphere((2.3 * (i - 1), 0.5, 1.9), 0.5), paint)
    scene.write(folder, "metals")
    describe(folder, eye=(0, 3.4, 9.5), look_at=(0, 0.75, -0.3), fov_deg=32, lens_radius=0.08, focus_distance=9.4,
             environment={"file": "sky.hdr", "scale": 1.0})


def street(folder):
    """A thousand bulbs between houses at night, each of them two triangles that shine down."""
    random = np.random.default_rng(7)
    scene = Gltf()
    ground = scene.material(pbrMetallicRoughness=lobe((0.35, 0.35, 0.37), 0, 0.6))
    scene.add(quad((-40, 0, 40), (80, 0, 0), (0, 0, -80)), ground)
    walls = [scene.material(pbrMetallicRoughness=lobe(c, 0, 1.0))
             for c in ((0.62, 0.54, 0.45), (0.5, 0.32, 0.26), (0.45, 0.5, 0.55))]
    houses = [[], [], []]
    for x in range(-5, 6):
        for z in range(-5, 6):
            height = 1.5 + 3.0 * random.random()
            houses[random.integers(3)].append(
                box((4 * x - 1.25, 0, 4 * z - 1.25), (4 * x + 1.25, height, 4 * z + 1.25)))
    for wall, group in zip(walls, houses):
        scene.add(joined(group), wall)
    colours = ((9, 5, 2), (9, 7, 4), (3, 6, 9))
    bulbs = [[], [], []]
    for _ in range(1000):
        along, across = random.uniform(-22, 22), 4 * random.integers(-5, 5) + 2 + random.uniform(-0.6, 0.6)
        x, z = (along, across) if random.random() < 0.5 else (across, along)
        bulbs[random.integers(3)].append(quad((x, 0.8 + 1.4 * random.random(), z), (0.12, 0, 0), (0, 0, 0.12)))
    for colour, group in zip(colours, bulbs):
        light = scene.material(emissiveFactor=[c / 9 for c in colour],
                               extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 90.0}})
        scene.add(joined(group), light)
    scene.write(folder, "street")
    describe(folder, eye=(15, 13, 24), look_at=(0, 0.2, 0), fov_deg=38, background=[0.004, 0.006, 0.012])


def glasses(folder):
    """Clear, tinted and frosted bodies of glass on a board, under a window."""
    scene = Gltf()
    (folder / "board.png").write_bytes(png(board()))
    wood = scene.material(pbrMetallicRoughness={
        "baseColorTexture": scene.texture("board.png"), "metallicFactor": 0, "roughnessFactor": 0.5})
    wall = scene.material(pbrMetallicRoughness=lobe((0.72, 0.7, 0.66), 0, 1.0))
    window = scene.material(emissiveFactor=[1, 1, 1],
                            extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 11.0}})
    scene.add(quad((-6, 0, 4), (12, 0, 0), (0, 0, -9), 3), wood)
    scene.add(quad((-6, 0, -5), (12, 0, 0), (0, 7, 0)), wall)
    scene.add(quad((-4.5, 5.5, -2.5), (3.2, 0, 0), (0, 0.9, 2.8)), window)
    for x, z, radius, roughness, tint in ((-1.9, -0.4, 0.95, 0, None), (0.15, -1.5, 1.1, 0, (0.25, 0.75, 0.5)),
                                          (2.15, -0.5, 0.9, 0.25, None), (0.25, 0.85, 0.55, 0, (0.9, 0.35, 0.12))):
        volume = {"thicknessFactor": 1.0}
        if tint:
            volume |= {"attenuationColor": tint, "attenuationDistance": 0.8}
        glass = scene.material(pbrMetallicRoughness=lobe((1, 1, 1), 0, roughness), extensions={
            "KHR_materials_transmission": {"transmissionFactor": 1.0}, "KHR_materials_ior": {"ior": 1.5},
            "KHR_materials_volume": volume})
        scene.add(sphere((x, radius + 1e-3, z), radius, 64, 128), glass)
    scene.write(folder, "glasses")
    describe(folder, eye=(0.4, 2.6, 7.4), look_at=(0.1, 0.75, -0.4), fov_deg=36, background=[0.25, 0.28, 0.33])


def lobe(colour, metallic, roughness):
    return {"baseColorFactor": [*colour, 1], "metallicFactor": metallic, "roughnessFactor": roughness}


def describe(folder, background=None, environment=None, **camera):
    document = {"cameras": [{"name": "gallery", **camera}]}
    if background:
        document["background"] = background
    if environment:
        document["environment"] = environment
    (folder / "raykiln.json").write_text(json.dumps(document, indent=2))


def tiles():
    """Two by two squares with joints."""
    v, u = np.mgrid[0:128, 0:128]
    light = ((u // 64 + v // 64) % 2)[..., None] * np.array([150, 145, 135]) + np.array([70, 72, 78])
    joint = ((u % 64 < 2) | (v % 64 < 2))[..., None]
    return np.where(joint, 40, light)


def board():
    v, u = np.mgrid[0:256, 0:256] / 256.0
    plank = np.floor(4 * v)
    grain = 0.5 + 0.5 * np.sin(2 * math.pi * (14 * v + 0.35 * np.sin(2 * math.pi * (u + 0.37 * plank))))
    shade = (0.72 + 0.1 * grain + 0.06 * np.cos(2.4 * plank))[..., None]
    gap = ((4 * v) % 1 < 0.03)[..., None]
    return np.where(gap, 60, shade * np.array([196, 152, 104]))


def sky(height=128):
    """Brighter towards the horizon, with a sun of some degrees; the lower half is ground."""
    v, u = np.mgrid[0:height, 0:2 * height]
    polar, turn = math.pi * (v + 0.5) / height, 2 * math.pi * ((u + 0.5) / (2 * height) - 0.5)
    up = np.cos(polar)
    direction = np.stack([np.sin(polar) * np.sin(turn), up, -np.sin(polar) * np.cos(turn)], -1)
    blue, pale, ground = np.array([0.16, 0.32, 0.75]), np.array([0.9, 0.85, 0.78]), np.array([0.16, 0.14, 0.12])
    share = np.exp(-3.5 * np.clip(up, 0, 1))[..., None]
    radiance = np.where((up > 0)[..., None], blue + (pale - blue) * share, ground)
    sun = np.array([-0.62, 0.42, 0.66])
    near = direction @ (sun / np.linalg.norm(sun))
    return radiance + np.where(near > math.cos(math.radians(4)), 90.0, 0.0)[..., None] * np.array([1.0, 0.86, 0.66])


SCENES = {"metals": metals, "street": street, "glasses": glasses}
