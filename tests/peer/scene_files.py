"""Writes scenes in the formats that raykiln reads: OBJ with MTL, glTF, and the sidecar raykiln.json."""

import base64
import json
from pathlib import Path

import numpy as np

PICTURE_TYPES = {".png": "image/png", ".jpg": "image/jpeg", ".exr": "image/x-exr"}


def write_sidecar(folder: Path, scene: str, sidecar: dict):
    (folder / "raykiln.json").write_text(json.dumps({"scene": scene, **sidecar}, indent=1))


def write_obj(folder: Path, meshes: list, materials: dict, sidecar: dict):
    """`materials`: name -> lines of MTL, such as "Kd 1 1 1"."""
    lines, first = ["mtllib scene.mtl"], 1
    for mesh in meshes:
        lines.append(f"usemtl {mesh.material}")
        lines += [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in mesh.positions]
        lines += [f"f {a + first} {b + first} {c + first}" for a, b, c in mesh.triangles]
        first += len(mesh.positions)
    (folder / "scene.obj").write_text("\n".join(lines) + "\n")
    blocks = [f"newmtl {name}\n" + "\n".join(body) for name, body in materials.items()]
    (folder / "scene.mtl").write_text("\n".join(blocks) + "\n")
    write_sidecar(folder, "scene.obj", sidecar)


class _Buffer:
    def __init__(self):
        self.data, self.views, self.accessors = b"", [], []

    def add(self, values, kind, component) -> int:
        values = np.ascontiguousarray(values, {5126: "<f4", 5125: "<u4"}[component])
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": values.nbytes})
        accessor = {"bufferView": len(self.views) - 1, "componentType": component, "type": kind,
                    "count": values.size if kind == "SCALAR" else len(values)}
        if kind == "VEC3":
            accessor |= {"min": values.min(0).tolist(), "max": values.max(0).tolist()}
        self.accessors.append(accessor)
        self.data += values.tobytes()
        return len(self.accessors) - 1


def write_gltf(folder: Path, meshes: list, materials: dict, sidecar: dict, textures=(), lights=()):
    """`materials`: name -> glTF material. `textures`: (file, sampler); a material names them by index.
    `lights`: (KHR_lights_punctual light, node that holds it)."""
    buffer, names = _Buffer(), list(materials)
    gltf_meshes = []
    for mesh in meshes:
        attributes = {"POSITION": buffer.add(mesh.positions, "VEC3", 5126)}
        if mesh.uvs is not None:
            attributes["TEXCOORD_0"] = buffer.add(mesh.uvs, "VEC2", 5126)
        gltf_meshes.append({"primitives": [{
            "attributes": attributes, "material": names.index(mesh.material),
            "indices": buffer.add(mesh.triangles.reshape(-1), "SCALAR", 5125)}]})
    used = sorted({e for m in materials.values() for e in m.get("extensions", {})} |
                  ({"KHR_lights_punctual"} if lights else set()) |
                  ({"KHR_texture_transform"} if "KHR_texture_transform" in json.dumps(materials) else set()))
    nodes = [{"mesh": i} for i in range(len(meshes))]
    nodes += [{**node, "extensions": {"KHR_lights_punctual": {"light": i}}}
              for i, (_, node) in enumerate(lights)]
    root = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}],
        "nodes": nodes, "meshes": gltf_meshes,
        "materials": [{"name": n, **m} for n, m in materials.items()],
        "accessors": buffer.accessors, "bufferViews": buffer.views,
        "buffers": [{"byteLength": len(buffer.data), "uri": "data:application/octet-stream;base64," +
                     base64.b64encode(buffer.data).decode()}],
    }
    if used:
        root["extensionsUsed"] = used
    if lights:
        root["extensions"] = {"KHR_lights_punctual": {"lights": [light for light, _ in lights]}}
    if textures:
        root["images"] = [{"uri": name} for name, _ in textures]
        root["samplers"] = [sampler for _, sampler in textures]
        root["textures"] = [{"source": i, "sampler": i} for i in range(len(textures))]
    (folder / "scene.gltf").write_text(json.dumps(root))
    write_sidecar(folder, "scene.gltf", sidecar)
