"""glTF and raykiln.json as a Mitsuba scene: a reader of its own, for what the compared scenes use."""

import base64
import json
from pathlib import Path

import mitsuba as mi
import numpy as np

from mitsuba_parts import Assembly, Surface, Unsupported, lambert, rgb

WRAPS = {10497: "repeat", 33071: "clamp", 33648: "mirror"}
FILTERS = {9728: "nearest", 9729: "bilinear"}
COMPONENTS = {5121: "u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}


class Reader:
    def __init__(self, path: Path):
        self.folder, self.root = path.parent, json.loads(path.read_text())
        self.data = base64.b64decode(self.root["buffers"][0]["uri"].split(",", 1)[1])

    def array(self, index):
        accessor = self.root["accessors"][index]
        view = self.root["bufferViews"][accessor["bufferView"]]
        begin = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        width = WIDTHS[accessor["type"]]
        values = np.frombuffer(self.data, COMPONENTS[accessor["componentType"]],
                               accessor["count"] * width, begin)
        return values.reshape(-1, width) if width > 1 else values

    def texture(self, info, factor, **more) -> dict:
        """A picture times a factor. Meshes carry the transformed coordinates; v grows downwards in
        both programs."""
        entry = self.root["textures"][info["index"]]
        sampler = self.root["samplers"][entry["sampler"]]
        if sampler.get("wrapS", 10497) != sampler.get("wrapT", 10497):
            raise Unsupported("wraps that differ")
        bitmap = mi.Bitmap(str(self.folder / self.root["images"][entry["source"]]["uri"]))
        linear = np.array(bitmap.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))
        return {"type": "bitmap", "raw": True, "bitmap": mi.Bitmap(linear * np.float32(factor)),
                "wrap_mode": WRAPS[sampler.get("wrapS", 10497)],
                "filter_type": FILTERS[sampler.get("magFilter", 9729)], **more}

    def alpha(self, info):
        entry = self.root["textures"][info["index"]]
        bitmap = mi.Bitmap(str(self.folder / self.root["images"][entry["source"]]["uri"]))
        values = np.array(bitmap)
        return values[..., 3].astype(np.float32) / 255 if values.shape[2] == 4 else None


def transformed(uvs, info):
    place = info.get("extensions", {}).get("KHR_texture_transform", {}) if info else {}
    turn, (sx, sy) = place.get("rotation", 0.0), place.get("scale", [1, 1])
    u, v = uvs[:, 0] * sx, uvs[:, 1] * sy
    c, s = np.cos(turn), np.sin(turn)
    offset = place.get("offset", [0, 0])
    return np.stack([c * u + s * v + offset[0], -s * u + c * v + offset[1]], 1)


def is_matte(material) -> bool:
    specular = material.get("extensions", {}).get("KHR_materials_specular", {}).get("specularFactor", 1)
    return specular == 0 and material["pbrMetallicRoughness"].get("metallicFactor", 1) == 0


def glass(material, facets) -> Surface:
    extensions, roughness = material["extensions"], material["pbrMetallicRoughness"]["roughnessFactor"]
    index = extensions.get("KHR_materials_ior", {}).get("ior", 1.5)
    volume = extensions.get("KHR_materials_volume", {})
    if not volume.get("thicknessFactor") or material["pbrMetallicRoughness"]["baseColorFactor"][:3] != [1, 1, 1]:
        raise Unsupported("sheets and tints")
    medium = None
    if "attenuationColor" in volume:
        absorbed = -np.log(volume["attenuationColor"]) / volume["attenuationDistance"]
        medium = {"type": "homogeneous", "albedo": 0.0, "sigma_t": {"type": "rawconstant", "value": absorbed.tolist()}}
    if roughness == 0:
        return Surface({"type": "dielectric", "int_ior": index, "ext_ior": 1.0}, interior=medium)
    return Surface(facets.glass(roughness**2, index), interior=medium)


def surface(reader, material, facets) -> Surface:
    pbr, extensions = material["pbrMetallicRoughness"], material.get("extensions", {})
    base = pbr.get("baseColorFactor", [1, 1, 1, 1])
    picture = pbr.get("baseColorTexture")
    colour = reader.texture(picture, base[:3]) if picture else base[:3]
    strength = extensions.get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1)
    emission = np.array(material.get("emissiveFactor", [0, 0, 0])) * strength
    shines = None
    if emission.any():
        glow = material.get("emissiveTexture")
        shines = reader.texture(glow, emission) if glow else rgb(emission)
    if "KHR_materials_transmission" in extensions:
        return glass(material, facets)
    if is_matte(material):
        bsdf = lambert(colour)
    elif picture:
        raise Unsupported("textures on facets")
    else:
        bsdf = facets.opaque(base[:3], pbr.get("metallicFactor", 1), pbr.get("roughnessFactor", 1) ** 2)
    mode = material.get("alphaMode", "OPAQUE")
    if mode == "BLEND" and not picture:
        bsdf = {"type": "mask", "opacity": base[3], "bsdf": bsdf}
    elif mode == "MASK" and picture:
        alpha = (reader.alpha(picture) * base[3] >= material.get("alphaCutoff", 0.5)).astype(np.float32)
        opacity = {**reader.texture(picture, [1, 1, 1]), "bitmap": mi.Bitmap(alpha[..., None])}
        bsdf = {"type": "mask", "opacity": opacity, "bsdf": bsdf}
    elif mode != "OPAQUE":
        raise Unsupported(mode)
    return Surface(bsdf, shines)


def rotated(quaternion, v):
    x, y, z, w = quaternion
    axis, v = np.array([x, y, z]), np.array(v, float)
    return v + 2 * np.cross(axis, np.cross(axis, v) + w * v)


def add_light(scene, light, node):
    power = np.array(light.get("color", [1, 1, 1])) * light.get("intensity", 1)
    if light["type"] == "point" and "range" not in light:
        scene.add({"type": "point", "position": node.get("translation", [0, 0, 0]), "intensity": rgb(power)})
    elif light["type"] == "directional":
        direction = rotated(node.get("rotation", [0, 0, 0, 1]), [0, 0, -1])
        scene.add({"type": "directional", "direction": direction.tolist(), "irradiance": rgb(power)})
    else:
        raise Unsupported(light["type"])


def convert(folder: Path, scratch: Path, size, facets) -> dict:
    sidecar = json.loads((folder / "raykiln.json").read_text())
    reader = Reader(folder / sidecar["scene"])
    root, scene = reader.root, Assembly(scratch)
    surfaces = [surface(reader, m, facets) for m in root["materials"]]
    for node in root["nodes"]:
        punctual = node.get("extensions", {}).get("KHR_lights_punctual")
        if punctual:
            add_light(scene, root["extensions"]["KHR_lights_punctual"]["lights"][punctual["light"]], node)
            continue
        if set(node) != {"mesh"}:
            raise Unsupported("placed meshes")
        for part in root["meshes"][node["mesh"]]["primitives"]:
            positions = reader.array(part["attributes"]["POSITION"])
            triangles = reader.array(part["indices"]).reshape(-1, 3)
            material = root["materials"][part["material"]]
            info = material["pbrMetallicRoughness"].get("baseColorTexture") or material.get("emissiveTexture")
            uvs = part["attributes"].get("TEXCOORD_0")
            scene.add_mesh(positions, triangles, surfaces[part["material"]],
                           None if uvs is None else transformed(reader.array(uvs), info))
    scene.add_sidecar_lights(sidecar, folder)
    return scene.finish(sidecar["camera"], size)
