#!/usr/bin/env python3
"""Writes the demo scene beside this script: demo.obj, demo.mtl and raykiln.json.

A box of 2 m, open towards the camera: a red and a green side, a square lamp under the ceiling, a
glass ball (an icosphere with vertex normals) and a tall box that is a mirror. The output is
committed; run this again after a change and commit both.
"""
import json
import math
import pathlib

FOLDER = pathlib.Path(__file__).resolve().parent
SPHERE_CENTRE = (0.42, 0.402, 0.38)  # 2 mm above the floor: faces that touch are another test
SPHERE_RADIUS = 0.4
SUBDIVISIONS = 4  # 20 * 4^4 = 5120 triangles


class Obj:
    def __init__(self):
        self.lines = ["# raykiln demo scene, written by make_demo.py", "mtllib demo.mtl"]
        self.vertices = 0
        self.normals = 0

    def vertex(self, p):
        self.lines.append("v %.7g %.7g %.7g" % tuple(p))
        self.vertices += 1
        return self.vertices

    def normal(self, n):
        self.lines.append("vn %.6g %.6g %.6g" % tuple(n))
        self.normals += 1
        return self.normals

    def group(self, name, material):
        self.lines += ["o " + name, "usemtl " + material]

    def face(self, corners):
        self.lines.append("f " + " ".join(str(c) for c in corners))

    def quad(self, name, material, corners):
        """Counter-clockwise corners, seen from the side of the normal."""
        self.group(name, material)
        self.face([self.vertex(c) for c in corners])


def add_room(obj):
    obj.quad("floor", "white", [(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)])
    obj.quad("ceiling", "white", [(-1, 2, -1), (1, 2, -1), (1, 2, 1), (-1, 2, 1)])
    obj.quad("back", "white", [(-1, 0, -1), (1, 0, -1), (1, 2, -1), (-1, 2, -1)])
    obj.quad("left", "red", [(-1, 0, 1), (-1, 0, -1), (-1, 2, -1), (-1, 2, 1)])
    obj.quad("right", "green", [(1, 0, -1), (1, 0, 1), (1, 2, 1), (1, 2, -1)])
    s, y = 0.35, 1.98
    obj.quad("lamp", "lamp", [(-s, y, -s), (s, y, -s), (s, y, s), (-s, y, s)])


def add_box(obj, name, material, centre, half, height, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))

    def corner(x, y, z):
        return (centre[0] + c * x + s * z, centre[1] + y, centre[2] - s * x + c * z)

    obj.group(name, material)
    low, high = 0.002, height
    ids = {}
    for x in (-half, half):
        for y in (low, high):
            for z in (-half, half):
                ids[(x > 0, y == high, z > 0)] = obj.vertex(corner(x, y, z))
    for face in (
        ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)),
        ((1, 0, 0), (0, 0, 0), (0, 1, 0), (1, 1, 0)),
        ((1, 0, 1), (1, 0, 0), (1, 1, 0), (1, 1, 1)),
        ((0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)),
        ((0, 1, 1), (1, 1, 1), (1, 1, 0), (0, 1, 0)),
        ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)),
    ):
        obj.face([ids[(bool(a), bool(b), bool(d))] for a, b, d in face])


def icosphere(subdivisions):
    """Unit directions and counter-clockwise triangles."""
    g = (1 + math.sqrt(5)) / 2
    points = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g),
              (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
             (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8),
             (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    points = [tuple(x / math.hypot(*p) for x in p) for p in points]
    for _ in range(subdivisions):
        middle = {}

        def between(i, j):
            key = (min(i, j), max(i, j))
            if key not in middle:
                m = tuple(a + b for a, b in zip(points[i], points[j]))
                points.append(tuple(x / math.hypot(*m) for x in m))
                middle[key] = len(points) - 1
            return middle[key]

        faces = [t for a, b, c in faces
                 for ab, bc, ca in [(between(a, b), between(b, c), between(c, a))]
                 for t in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))]
    return points, faces


def add_sphere(obj, name, material, centre, radius, subdivisions):
    obj.group(name, material)
    points, faces = icosphere(subdivisions)
    ids = [(obj.vertex([c + radius * x for c, x in zip(centre, p)]), obj.normal(p)) for p in points]
    for face in faces:
        obj.face(["%d//%d" % ids[i] for i in face])


MTL = """# raykiln demo scene, written by make_demo.py
newmtl white
Kd 0.73 0.73 0.73
illum 1

newmtl red
Kd 0.65 0.05 0.05
illum 1

newmtl green
Kd 0.12 0.45 0.15
illum 1

newmtl lamp
Kd 0 0 0
Ke 13 11.5 9
illum 1

newmtl glass
Kd 0 0 0
Ks 1 1 1
Ni 1.5
Ns 1e5
d 0
illum 7

newmtl mirror
Kd 0 0 0
Ks 0.95 0.95 0.95
Ns 1e5
illum 3
"""

SIDECAR = {
    "scene": "demo.obj",
    "cameras": [
        {"name": "front", "eye": [0, 1, 4.1], "look_at": [0, 1, 0], "up": [0, 1, 0],
         "fov_deg": 35.6},
    ],
    "background": [0.12, 0.14, 0.18],
    "materials": {
        "glass": {"diffuse": [0, 0, 0], "specular": [1, 1, 1], "transparent": 1,
                  "specular_exp": 1e5, "index_of_refraction": 1.5},
        "mirror": {"specular": [0.95, 0.95, 0.95], "specular_exp": 1e5},
    },
}


def main():
    obj = Obj()
    add_room(obj)
    add_box(obj, "tall_mirror", "mirror", (-0.38, 0, -0.32), 0.29, 1.2, 20)
    add_sphere(obj, "ball", "glass", SPHERE_CENTRE, SPHERE_RADIUS, SUBDIVISIONS)
    (FOLDER / "demo.obj").write_text("\n".join(obj.lines) + "\n")
    (FOLDER / "demo.mtl").write_text(MTL)
    (FOLDER / "raykiln.json").write_text(json.dumps(SIDECAR, indent=2) + "\n")


if __name__ == "__main__":
    main()
