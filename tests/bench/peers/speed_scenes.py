"""The scenes of the whole-render table, beside those of tests/peer."""

import subprocess
from pathlib import Path

import numpy as np

import scene_files
import scenes
from shapes import Mesh, box, quad, room

ROOT = Path(__file__).resolve().parents[3]


def scan(folder: Path):
    """The Stanford dragon at its finest, 871 thousand triangles, on a floor below a sky."""
    printed = subprocess.run(["node", str(ROOT / "tests/support/fetch_dragon.mjs"), "1"], check=True,
                             capture_output=True, text=True).stdout
    lines = Path(printed.split()[-1]).read_text().splitlines()
    positions = np.array([line.split()[1:4] for line in lines if line.startswith("v ")], float)
    triangles = np.array([line.split()[1:4] for line in lines if line.startswith("f ")], int) - 1
    floor = float(positions[:, 1].min())
    # MTL names the scan's and the floor's material; the floor comes first because it is small.
    scene_files.write_obj(folder, [quad((-200, floor, 200), (400, 0, 0), (0, 0, -400), "floor"),
                                   Mesh(positions, triangles, "scan")],
                          {"floor": ["Kd 0.4 0.35 0.3"], "scan": ["Kd 0.7 0.7 0.65"]},
                          {"camera": {"eye": [0, 60, 260], "look_at": [0, 50, 0], "fov_deg": 40},
                           "background": [0.5, 0.6, 0.8]})


def eight_points(folder: Path):
    meshes = room(lamp=0) + [box((-0.33, 0.6, -0.3), (0.3, 0.6, 0.3), "white", 18)]
    materials = {k: v for k, v in scenes.ROOM_MTL.items() if k != "lamp"}
    lights = [{"position": [x, y, z], "intensity": [0.3 * (k + 1), 0.4, 0.3 * (8 - k)]}
              for k, (x, y, z) in enumerate((x, y, z) for x in (-0.7, 0.7) for y in (0.5, 1.7) for z in (-0.6, 0.6))]
    scene_files.write_obj(folder, meshes, materials,
                          {"camera": scenes.FRONT, "background": [0, 0, 0], "point_lights": lights})


SCENES = {
    "Cornell box": (scenes.cornell, 64),
    "glass and mirror spheres": (scenes.glass_and_mirror, 64),
    "scan, 871k triangles": (scan, 16),
    "eight point lights": (eight_points, 16),
    "500 small lights": (lambda folder: scenes.many_emitters(folder, 5), 64),
}
