"""OBJ, MTL and raykiln.json as a Mitsuba scene: a reader of its own, for what the compared scenes use."""

import json
from pathlib import Path

import numpy as np

from mitsuba_parts import Assembly, Surface, Unsupported, lambert, rgb


def numbers(words):
    return [float(w) for w in words]


def read_mtl(path: Path) -> dict:
    materials, current = {}, None
    for words in (line.split() for line in path.read_text().splitlines()):
        if not words or words[0].startswith("#"):
            continue
        if words[0] == "newmtl":
            current = materials.setdefault(words[1], {})
        elif words[0] in ("Kd", "Ke", "Ks"):
            current[words[0]] = numbers(words[1:4])
        elif words[0] in ("Ns", "Ni", "d", "illum"):
            current[words[0]] = float(words[1])
        else:
            raise Unsupported(words[0])
    return materials


def read_obj(path: Path):
    """Positions, and triangles by material in the order of the file."""
    positions, faces, material = [], {}, "default"
    for words in (line.split() for line in path.read_text().splitlines()):
        if not words or words[0] in ("#", "mtllib", "o", "g", "s"):
            continue
        if words[0] == "v":
            positions.append(numbers(words[1:4]))
        elif words[0] == "usemtl":
            material = words[1]
        elif words[0] == "f":
            corners = [int(w.split("/")[0]) - 1 for w in words[1:]]
            faces.setdefault(material, []).extend(
                [corners[0], b, c] for b, c in zip(corners[1:], corners[2:]))
        else:
            raise Unsupported(words[0])
    return np.array(positions), {name: np.array(t) for name, t in faces.items()}


def surface(mtl: dict, override: dict) -> Surface:
    diffuse = override.get("diffuse", mtl.get("Kd", [0, 0, 0]))
    specular = override.get("specular", mtl.get("Ks", [0, 0, 0]))
    emission = override.get("emission", mtl.get("Ke", [0, 0, 0]))
    transparent, exponent = override.get("transparent", 0), override.get("specular_exp", mtl.get("Ns", 0))
    if any(specular) and exponent < 1e5:
        raise Unsupported("broad Phong lobes")
    if transparent == 1 and not any(diffuse):
        bsdf = {"type": "dielectric", "int_ior": override["index_of_refraction"], "ext_ior": 1.0}
    elif transparent:
        raise Unsupported("transparent and diffuse")
    elif any(specular) and any(diffuse):
        raise Unsupported("specular and diffuse")
    elif any(specular):
        bsdf = {"type": "twosided", "bsdf": {"type": "conductor", "material": "none",
                                             "specular_reflectance": rgb(specular)}}
    else:
        bsdf = lambert(diffuse)
    return Surface(bsdf, rgb(emission) if any(emission) else None)


def convert(folder: Path, scratch: Path, size) -> dict:
    sidecar = json.loads((folder / "raykiln.json").read_text())
    path = folder / sidecar["scene"]
    positions, faces = read_obj(path)
    materials = read_mtl(path.with_suffix(".mtl"))
    scene = Assembly(scratch)
    for name, triangles in faces.items():
        look = surface(materials[name], sidecar.get("materials", {}).get(name, {}))
        scene.add_mesh(positions, triangles, look)
    scene.add_sidecar_lights(sidecar, folder)
    camera = sidecar["camera"] if "camera" in sidecar else sidecar["cameras"][0]
    return scene.finish(camera, size)
