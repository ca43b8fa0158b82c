"""One whole glTF file, and many that are broken in one place each: (name, file as bytes).

Made for comparing verdicts: each break is one that a reader can meet in the wild.
"""

import base64
import copy
import json
import struct

POSITIONS = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
INDICES = struct.pack("<3H", 0, 1, 2) + b"\0\0"


def whole() -> dict:
    data = POSITIONS + INDICES
    return {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0}, {"camera": 0}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0.2, 1]}}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3,
             "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": 3}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
        "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," +
                     base64.b64encode(data).decode()}],
    }


def _set(path, value):
    def change(root):
        *way, last = path
        for key in way:
            root = root[key]
        root[last] = value
    return change


def _drop(*path):
    def change(root):
        *way, last = path
        for key in way:
            root = root[key]
        del root[last]
    return change


def _data(data):
    def change(root):
        root["buffers"][0] = {"byteLength": len(data), "uri": "data:application/octet-stream;base64," +
                              base64.b64encode(data).decode()}
    return change


BREAKS = {
    "no_asset": _drop("asset"),
    "version_3": _set(("asset", "version"), "3.0"),
    "version_is_number": _set(("asset", "version"), 2.0),
    "scene_out_of_range": _set(("scene",), 5),
    "node_out_of_range": _set(("scenes", 0, "nodes"), [9]),
    "mesh_out_of_range": _set(("nodes", 0, "mesh"), 4),
    "camera_out_of_range": _set(("nodes", 1, "camera"), 3),
    "node_is_its_own_child": _set(("nodes", 0, "children"), [0]),
    "two_parents": _set(("nodes",), [{"mesh": 0, "children": [2]}, {"camera": 0, "children": [2]}, {}]),
    "scale_of_words": _set(("nodes", 0, "scale"), ["a", "b", "c"]),
    "scale_of_two": _set(("nodes", 0, "scale"), [1, 2]),
    "matrix_of_nine": _set(("nodes", 0, "matrix"), [1, 0, 0, 0, 1, 0, 0, 0, 1]),
    "rotation_not_unit": _set(("nodes", 0, "rotation"), [1, 1, 1, 1]),
    "no_position": _set(("meshes", 0, "primitives", 0, "attributes"), {}),
    "accessor_out_of_range": _set(("meshes", 0, "primitives", 0, "attributes", "POSITION"), 7),
    "position_of_words": _set(("meshes", 0, "primitives", 0, "attributes", "POSITION"), "zero"),
    "no_primitives": _set(("meshes", 0, "primitives"), []),
    "mode_9": _set(("meshes", 0, "primitives", 0, "mode"), 9),
    "indices_of_floats": _set(("accessors", 1, "componentType"), 5126),
    "positions_of_shorts": _set(("accessors", 0, "componentType"), 5122),
    "positions_of_pairs": _set(("accessors", 0, "type"), "VEC2"),
    "unknown_component": _set(("accessors", 0, "componentType"), 1234),
    "unknown_type": _set(("accessors", 0, "type"), "VEC5"),
    "count_0": _set(("accessors", 0, "count"), 0),
    "count_negative": _set(("accessors", 0, "count"), -3),
    "count_beyond_view": _set(("accessors", 0, "count"), 400),
    "offset_unaligned": _set(("accessors", 1, "byteOffset"), 1),
    "view_beyond_buffer": _set(("bufferViews", 0, "byteLength"), 4000),
    "view_out_of_range": _set(("accessors", 0, "bufferView"), 8),
    "stride_3": _set(("bufferViews", 0, "byteStride"), 3),
    "buffer_shorter_than_said": _set(("buffers", 0, "byteLength"), 999),
    "buffer_not_there": _set(("buffers", 0, "uri"), "gone.bin"),
    "buffer_bad_base64": _set(("buffers", 0, "uri"), "data:application/octet-stream;base64,!!!!"),
    "index_beyond_vertices": _data(POSITIONS + struct.pack("<3H", 0, 1, 77) + b"\0\0"),
    "position_nan": _data(struct.pack("<9f", 0, 0, 0, float("nan"), 0, 0, 0, 1, 0) + INDICES),
    "position_infinite": _data(struct.pack("<9f", 0, 0, 0, float("inf"), 0, 0, 0, 1, 0) + INDICES),
    "material_out_of_range": _set(("meshes", 0, "primitives", 0, "material"), 2),
    "base_colour_of_three": _set(("materials", 0, "pbrMetallicRoughness", "baseColorFactor"), [1, 1, 1]),
    "base_colour_above_1": _set(("materials", 0, "pbrMetallicRoughness", "baseColorFactor"), [3, 1, 1, 1]),
    "roughness_above_1": _set(("materials", 0, "pbrMetallicRoughness", "roughnessFactor"), 2),
    "metallic_of_words": _set(("materials", 0, "pbrMetallicRoughness", "metallicFactor"), "full"),
    "alpha_mode_unknown": _set(("materials", 0, "alphaMode"), "HALF"),
    "texture_out_of_range": _set(("materials", 0, "pbrMetallicRoughness", "baseColorTexture"), {"index": 3}),
    "camera_of_unknown_type": _set(("cameras", 0, "type"), "fisheye"),
    "yfov_0": _set(("cameras", 0, "perspective", "yfov"), 0),
    "requires_unknown_extension": lambda root: root.update(
        extensionsUsed=["ACME_magic"], extensionsRequired=["ACME_magic"]),
    "nodes_not_a_list": _set(("nodes",), {"mesh": 0}),
    "min_max_missing": lambda root: [root["accessors"][0].pop(k) for k in ("min", "max")],
    "min_max_wrong": _set(("accessors", 0, "max"), [0.5, 0.5, 0]),
}


def files():
    yield "whole", json.dumps(whole()).encode()
    for name, change in BREAKS.items():
        root = copy.deepcopy(whole())
        change(root)
        yield name, json.dumps(root).encode()
    text = json.dumps(whole()).encode()
    yield "cut_in_half", text[: len(text) // 2]
    yield "empty", b""
