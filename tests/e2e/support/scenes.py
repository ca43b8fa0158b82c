"""Scene bytes for the tests: small enough to render in milliseconds, or as large as asked."""

import io
import json
import struct
import zipfile

BOX_OBJ = """\
mtllib box.mtl
v -1 -1 -1
v 1 -1 -1
v 1 1 -1
v -1 1 -1
v -1 -1 1
v 1 -1 1
v 1 1 1
v -1 1 1
usemtl grey
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 4 8 7 3
f 1 5 8 4
usemtl red
f 2 3 7 6
"""

BOX_MTL = """\
newmtl grey
Kd 0.7 0.7 0.7
newmtl red
Kd 0.8 0.1 0.1
"""

SIDECAR = {
    "camera": {"eye": [3, 2, 5], "look_at": [0, 0, 0], "up": [0, 1, 0], "fov_deg": 45},
    "background": [0.2, 0.3, 0.4],
    "point_lights": [{"position": [3, 4, 5], "intensity": [60, 60, 60]}],
}


def zip_of(files: dict, compression=zipfile.ZIP_DEFLATED) -> bytes:
    """A zip whose bytes depend on `files` alone, so that its digest is stable."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", compression) as archive:
        for name, content in files.items():
            entry = zipfile.ZipInfo(name, (2020, 1, 1, 0, 0, 0))
            entry.compress_type = compression
            archive.writestr(entry, content)
    return buffer.getvalue()


def box_files(tag: str = "") -> dict:
    """A grey box with one red side; `tag` makes another scene of the same geometry."""
    files = {"box.obj": BOX_OBJ, "box.mtl": BOX_MTL, "raykiln.json": json.dumps(SIDECAR)}
    if tag:
        files["box.mtl"] = BOX_MTL + f"# {tag}\n"
    return files


def box_zip(tag: str = "") -> bytes:
    return zip_of(box_files(tag))


def grid_obj(cells: int) -> bytes:
    """A wavy floor of 2 * cells^2 triangles, to give the tree and the paths work."""
    lines = []
    for j in range(cells + 1):
        for i in range(cells + 1):
            x, z = 4 * i / cells - 2, 4 * j / cells - 2
            lines.append(f"v {x:.6f} {0.1 * ((i * 7 + j * 13) % 5):.4f} {z:.6f}")
    for j in range(cells):
        for i in range(cells):
            a = j * (cells + 1) + i + 1
            lines.append(f"f {a} {a + cells + 1} {a + 1}")
            lines.append(f"f {a + 1} {a + cells + 1} {a + cells + 2}")
    return ("\n".join(lines) + "\n").encode()


def grid_zip(cells: int) -> bytes:
    return zip_of({"grid.obj": grid_obj(cells), "raykiln.json": json.dumps(SIDECAR)})


def triangle_glb(positions=((0, 0, 0), (1, 0, 0), (0, 1, 0)), **extra) -> bytes:
    """A GLB with one triangle; `extra` adds or replaces members of the JSON document."""
    points = b"".join(struct.pack("<3f", *p) for p in positions)
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(positions), "type": "VEC3",
             "min": [0, 0, 0], "max": [1, 1, 0]}
        ],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": len(points)}],
        "buffers": [{"byteLength": len(points)}],
    }
    document.update(extra)
    return glb_of(document, points)


def glb_of(document: dict, binary: bytes) -> bytes:
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    body = struct.pack("<II", len(text), 0x4E4F534A) + text
    body += struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<III", 0x46546C67, 2, 12 + len(body)) + body
