"""Pieces of Mitsuba scenes that both formats share: meshes, cameras, lights of the sidecar, film.

Conventions that differ, and what is done about them:
- Emitters of Mitsuba shine along the normal alone, those of raykiln to both sides: scenes show no backs.
- Mitsuba's surfaces are black from behind: all opaque ones become `twosided`.
- Both filter films by a box, so a pixel is the mean of its samples.
- An environment of raykiln is constant within a texel, whose middle is half a texel off the pole;
  Mitsuba interpolates, and its first row is the pole: texels are repeated 8 x 8 times.
"""

from dataclasses import dataclass, field
from pathlib import Path

import mitsuba as mi
import numpy as np


class Unsupported(Exception):
    """What the conversion does not know. Never a guess."""


@dataclass
class Surface:
    """What the converter knows of a material: a Mitsuba BSDF, and a radiance or a texture of it."""
    bsdf: dict
    emission: object = None
    interior: dict = None  # medium inside


def rgb(values) -> dict:
    return {"type": "rgb", "value": [float(v) for v in values]}


def lambert(reflectance) -> dict:
    if not isinstance(reflectance, dict):
        reflectance = rgb(reflectance)
    return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": reflectance}}


def write_ply(path: Path, positions, triangles, uvs=None):
    columns = [np.asarray(positions, "<f4")]
    names = ["x", "y", "z"]
    if uvs is not None:
        columns.append(np.asarray(uvs, "<f4"))
        names += ["u", "v"]
    vertices = np.concatenate(columns, 1)
    faces = np.zeros(len(triangles), [("n", "u1"), ("v", "<i4", 3)])
    faces["n"], faces["v"] = 3, triangles
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}",
            *(f"property float {n}" for n in names), f"element face {len(faces)}",
            "property list uchar int vertex_indices", "end_header"]
    path.write_bytes(("\n".join(head) + "\n").encode() + vertices.tobytes() + faces.tobytes())


@dataclass
class Assembly:
    """Collects shapes and lights; meshes go through files, because plug-ins read files."""
    folder: Path
    parts: dict = field(default_factory=lambda: {"type": "scene"})
    has_medium: bool = False

    def add(self, part: dict):
        self.parts[f"part{len(self.parts)}"] = part

    def add_mesh(self, positions, triangles, surface: Surface, uvs=None):
        path = self.folder / f"mesh{len(self.parts)}.ply"
        write_ply(path, positions, triangles, uvs)
        part = {"type": "ply", "filename": str(path), "face_normals": True, "bsdf": surface.bsdf}
        if surface.emission is not None:
            part["emitter"] = {"type": "area", "radiance": surface.emission}
        if surface.interior is not None:
            part["interior"] = surface.interior
            self.has_medium = True
        self.add(part)

    def add_sidecar_lights(self, sidecar: dict, folder: Path):
        for light in sidecar.get("point_lights", []):
            self.add({"type": "point", "position": light["position"], "intensity": rgb(light["intensity"])})
        for kind in ("spot_lights", "directional_lights"):
            if sidecar.get(kind):
                raise Unsupported(kind)
        if "environment" in sidecar:
            self.add(environment(folder, sidecar["environment"]))
        elif any(sidecar.get("background", [0])):
            self.add({"type": "constant", "radiance": rgb(sidecar["background"])})

    def finish(self, camera: dict, size, integrator="path") -> dict:
        self.parts["integrator"] = {"type": "volpath" if self.has_medium else integrator,
                                    "max_depth": -1, "rr_depth": 5}
        self.parts["sensor"] = sensor(camera, size)
        return self.parts


def sensor(camera: dict, size) -> dict:
    look = mi.ScalarTransform4f().look_at(origin=camera["eye"], target=camera["look_at"],
                                          up=camera.get("up", [0, 1, 0]))
    lens = {"type": "perspective"}
    if camera.get("lens_radius"):
        lens = {"type": "thinlens", "aperture_radius": camera["lens_radius"],
                "focus_distance": camera["focus_distance"]}
    return {**lens, "fov": camera.get("fov_deg", 40), "fov_axis": "y", "to_world": look,
            "near_clip": 1e-3, "far_clip": 1e5, "sampler": {"type": "independent"},
            "film": {"type": "hdrfilm", "width": size[0], "height": size[1], "rfilter": {"type": "box"},
                     "pixel_format": "rgb", "component_format": "float32"}}


def environment(folder: Path, entry: dict) -> dict:
    texels = np.array(mi.Bitmap(str(folder / entry["file"])).convert(
        mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))
    height, width = texels.shape[:2]
    # A row of Mitsuba's that lies on the border of two texels is their mean, so that nothing is shifted.
    places = np.arange(8 * height + 1) / 8
    above, below = (np.clip(np.floor(places + e).astype(int), 0, height - 1) for e in (-1e-6, 1e-6))
    fine = np.repeat(0.5 * (texels[above] + texels[below]), 8, axis=1).astype(np.float32)
    # The middle of a row is -z in raykiln and +z in Mitsuba.
    turn = mi.ScalarTransform4f().rotate([0, 1, 0], entry.get("rotation_degrees", 0) + TURN)
    return {"type": "envmap", "bitmap": mi.Bitmap(np.ascontiguousarray(fine)),
            "scale": entry.get("scale", 1.0), "to_world": turn}


TURN = 180.0
