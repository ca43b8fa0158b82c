"""Meshes for the compared scenes: arrays of positions (n x 3), triangles (m x 3) and, where a
texture wants them, coordinates (n x 2, glTF's sense: v grows downwards)."""

from dataclasses import dataclass

import numpy as np


@dataclass
class Mesh:
    positions: np.ndarray
    triangles: np.ndarray
    material: str
    uvs: np.ndarray = None


def quad(corner, u, v, material, uvs=False) -> Mesh:
    """Faces u x v."""
    corner, u, v = (np.asarray(x, float) for x in (corner, u, v))
    positions = np.array([corner, corner + u, corner + u + v, corner + v])
    return Mesh(positions, np.array([[0, 1, 2], [0, 2, 3]]), material,
                np.array([[0, 1], [1, 1], [1, 0], [0, 0]], float) if uvs else None)


def box(centre, half, material, turn_degrees=0.0) -> Mesh:
    """Turned about y; its faces look outwards."""
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    turn = np.radians(turn_degrees)
    rotate = np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]])
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    triangles = [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))]
    return Mesh(np.asarray(centre) + (signs * half) @ rotate.T, np.array(triangles), material)


def sphere(centre, radius, material, divisions=3) -> Mesh:
    """A twenty-faced body divided so many times, flat faces, corners on the sphere."""
    g = (1 + 5 ** 0.5) / 2
    points = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g),
              (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    points = [np.array(p) / np.linalg.norm(p) for p in points]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
             (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8),
             (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(divisions):
        faces = _divided(points, faces)
    return Mesh(np.asarray(centre) + radius * np.array(points), np.array(faces), material)


def _divided(points, faces):
    middle_of, result = {}, []

    def middle(a, b):
        key = (min(a, b), max(a, b))
        if key not in middle_of:
            point = points[a] + points[b]
            middle_of[key] = len(points)
            points.append(point / np.linalg.norm(point))
        return middle_of[key]

    for a, b, c in faces:
        ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
        result += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return result


def room(half=1.0, height=2.0, names=("left", "right", "white"), lamp=0.25) -> list:
    """A box open to +z with a hole of half-side `lamp` in its ceiling, where a lamp fits flush: its
    back, which shines in one of the two programs alone, is then seen from nowhere."""
    left, right, white = names
    h, top = half, height
    strips = [((-h, -h), (h, -lamp)), ((-h, lamp), (h, h)),
              ((-h, -lamp), (-lamp, lamp)), ((lamp, -lamp), (h, lamp))]
    ceiling = [quad((x0, top, z0), (x1 - x0, 0, 0), (0, 0, z1 - z0), white)
               for (x0, z0), (x1, z1) in strips] if lamp else \
        [quad((-h, top, -h), (2 * h, 0, 0), (0, 0, 2 * h), white)]
    return ceiling + [
        quad((-h, 0, h), (2 * h, 0, 0), (0, 0, -2 * h), white),
        quad((-h, 0, -h), (2 * h, 0, 0), (0, top, 0), white),
        quad((-h, 0, h), (0, 0, -2 * h), (0, top, 0), left),
        quad((h, 0, -h), (0, 0, 2 * h), (0, top, 0), right),
    ]


def lamp_in_ceiling(half, height, material) -> Mesh:
    return quad((-half, height, -half), (2 * half, 0, 0), (0, 0, 2 * half), material)
