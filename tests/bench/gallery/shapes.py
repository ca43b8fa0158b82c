"""Shapes and pictures for the gallery's scenes, and the glTF files that hold them."""

import json
import math
import struct
import zlib

import numpy as np


def grid(rows, columns):
    """Triangles of a grid of (rows + 1) x (columns + 1) points, counter-clockwise in (column, row)."""
    row, column = np.mgrid[0:rows, 0:columns]
    a = (row * (columns + 1) + column).ravel()
    b, c, d = a + 1, a + columns + 2, a + columns + 1
    return np.stack([np.stack([a, b, c], 1), np.stack([a, c, d], 1)], 1).reshape(-1, 3)


def sphere(centre, radius, rows=48, columns=96):
    v, u = np.mgrid[0:rows + 1, 0:columns + 1]
    polar, turn = math.pi * (1 - v / rows), 2 * math.pi * u / columns
    normal = np.stack([np.sin(polar) * np.sin(turn), np.cos(polar), np.sin(polar) * np.cos(turn)], -1).reshape(-1, 3)
    uv = np.stack([u / columns, 1 - v / rows], -1).reshape(-1, 2)
    triangles = grid(rows, columns)
    return {"position": np.asarray(centre) + radius * normal, "normal": normal, "uv": uv,
            "triangles": triangles[kept(triangles, rows, columns)]}


def kept(triangles, rows, columns):
    """At the poles one triangle of two has no area."""
    row = triangles // (columns + 1)
    return ~(((row == 0).sum(1) == 2) | ((row == rows).sum(1) == 2))


def quad(corner, u, v, repeat=1.0):
    """corner, corner + u, corner + u + v, corner + v; faces u x v."""
    corner, u, v = (np.asarray(x, float) for x in (corner, u, v))
    normal = np.cross(u, v)
    return {"position": np.array([corner, corner + u, corner + u + v, corner + v]),
            "normal": np.tile(normal / np.linalg.norm(normal), (4, 1)),
            "uv": repeat * np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float),
            "triangles": np.array([[0, 1, 2], [0, 2, 3]])}


def box(low, high):
    low, high = np.asarray(low, float), np.asarray(high, float)
    sides = []
    for axis in range(3):
        u, v = np.zeros(3), np.zeros(3)
        u[(axis + 1) % 3] = (high - low)[(axis + 1) % 3]
        v[(axis + 2) % 3] = (high - low)[(axis + 2) % 3]
        sides += [quad(low, v, u), quad(high, -u, -v)]
    return joined(sides)


def joined(shapes):
    first, triangles = 0, []
    for shape in shapes:
        triangles.append(shape["triangles"] + first)
        first += len(shape["position"])
    return {**{name: np.concatenate([s[name] for s in shapes]) for name in ("position", "normal", "uv")},
            "triangles": np.concatenate(triangles)}


def png(pixels):
    """An 8-bit RGB picture, rows from the top."""
    height, width, _ = pixels.shape
    rows = b"".join(b"\0" + row.astype(np.uint8).tobytes() for row in pixels)

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) + \
        chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")


def hdr(radiance):
    """A Radiance file of shared exponents, not run-length coded."""
    height, width, _ = radiance.shape
    _, exponent = np.frexp(radiance.max(-1))
    mantissa = np.floor(np.ldexp(radiance, (8 - exponent)[..., None])).clip(0, 255)
    pixels = np.concatenate([mantissa, (exponent + 128)[..., None]], -1).astype(np.uint8)
    return f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode() + pixels.tobytes()


class Gltf:
    """Meshes and materials, written as NAME.gltf and NAME.bin."""

    def __init__(self):
        self.binary, self.views, self.accessors = b"", [], []
        self.meshes, self.materials, self.textures, self.extensions = [], [], [], set()

    def material(self, **fields):
        self.extensions |= set(fields.get("extensions", {}))
        self.materials.append({"doubleSided": True, **fields})
        return len(self.materials) - 1

    def texture(self, file):
        self.textures.append(file)
        return {"index": len(self.textures) - 1}

    def add(self, shape, material):
        attributes = {"POSITION": self.accessor(shape["position"], "VEC3", True),
                      "NORMAL": self.accessor(shape["normal"], "VEC3"), "TEXCOORD_0": self.accessor(shape["uv"], "VEC2")}
        indices = self.accessor(shape["triangles"].reshape(-1, 1), "SCALAR")
        self.meshes.append({"primitives": [{"attributes": attributes, "indices": indices, "material": material}]})

    def accessor(self, values, kind, bounds=False):
        whole = kind == "SCALAR"
        values = np.ascontiguousarray(values, np.uint32 if whole else np.float32)
        entry = {"bufferView": len(self.views), "componentType": 5125 if whole else 5126, "count": len(values), "type": kind}
        if bounds:
            entry |= {"min": values.min(0).tolist(), "max": values.max(0).tolist()}
        self.views.append({"buffer": 0, "byteOffset": len(self.binary), "byteLength": values.nbytes})
        self.binary += values.tobytes()
        self.accessors.append(entry)
        return len(self.accessors) - 1

    def write(self, folder, name):
        document = {
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(self.meshes)))}],
            "nodes": [{"mesh": i} for i in range(len(self.meshes))], "meshes": self.meshes, "materials": self.materials,
            "accessors": self.accessors, "bufferViews": self.views,
            "buffers": [{"uri": f"{name}.bin", "byteLength": len(self.binary)}]}
        if self.textures:
            document |= {"images": [{"uri": file} for file in self.textures],
                         "textures": [{"source": i} for i in range(len(self.textures))]}
        if self.extensions:
            document["extensionsUsed"] = sorted(self.extensions)
        (folder / f"{name}.gltf").write_text(json.dumps(document))
        (folder / f"{name}.bin").write_bytes(self.binary)
