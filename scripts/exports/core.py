"""Reads the GLB files of a folder as core glTF, by their JSON alone: the whole tree is there, and its images.

Every extension is passed over but KHR_mesh_quantization, whose numbers need nothing but the node's transform.
"""

import json
import struct
import sys
from pathlib import Path

import numpy as np

TYPES = {5120: "i1", 5121: "u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


def read(path):
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + length]), data[28 + length:]


def numbers(gltf, blob, index):
    accessor = gltf["accessors"][index]
    view = gltf["bufferViews"][accessor["bufferView"]]
    kind = np.dtype(TYPES[accessor["componentType"]])
    width = WIDTHS[accessor["type"]]
    stride = view.get("byteStride", kind.itemsize * width)
    start = view["byteOffset"] + accessor.get("byteOffset", 0)
    shape, strides = (accessor["count"], width), (stride, kind.itemsize)
    return np.ndarray(shape, kind, blob, start, strides)


def turned(points, rotation):
    x, y, z, w = rotation
    way = np.array([x, y, z])
    return points + 2 * np.cross(way, np.cross(way, points) + w * points)


def whole(path):
    gltf, blob = read(path)
    found, triangles = [], 0
    # The nodes that an importer without levels shows, or the finest by its name.
    open_nodes = [(gltf["scenes"][0]["nodes"][0], [])]
    while open_nodes:
        index, above = open_nodes.pop()
        node = gltf["nodes"][index]
        if node["name"].endswith(("_LOD1", "_LOD2")):
            continue
        chain = [node] + above
        open_nodes += [(child, chain) for child in node.get("children", [])]
        if "mesh" not in node:
            continue
        for primitive in gltf["meshes"][node["mesh"]]["primitives"]:
            points = numbers(gltf, blob, primitive["attributes"]["POSITION"]).astype(float)
            indices = numbers(gltf, blob, primitive["indices"])
            assert indices.max() < len(points)
            triangles += len(indices) // 3
            corners = np.array([points.min(axis=0), points.max(axis=0)])
            if any("rotation" in step for step in chain):
                corners = points
            for step in chain:
                corners = corners * step.get("scale", [1, 1, 1])
                corners = turned(corners, step.get("rotation", [0, 0, 0, 1])) + step.get("translation", [0, 0, 0])
            found += [corners.min(axis=0), corners.max(axis=0)]
    for image in gltf.get("images", []):
        view = gltf["bufferViews"][image["bufferView"]]
        assert blob[view["byteOffset"]:][:8] == b"\x89PNG\r\n\x1a\n"
    box = np.array(found)
    return triangles, box.min(axis=0), box.max(axis=0), len(gltf.get("images", []))


folder = Path(sys.argv[1])
for prefix in ["", "scene-"]:
    first = None
    names = ["merged", "merged-quantized", "nodes", "nodes-quantized"] + ([] if prefix else ["lod", "named-lod"])
    for name in names:
        path = folder / f"{prefix}{name}.glb"
        triangles, low, high, images = whole(path)
        first = first or (triangles, low, high, images)
        assert triangles == first[0] and images == first[3], f"{path}: {triangles} triangles, {images} images"
        # A step of the grid over the whole tree is a third of a millimetre.
        assert np.abs(low - first[1]).max() < 2e-3 and np.abs(high - first[2]).max() < 2e-3, f"{path}: {low} to {high}"
        print(f"{path.name}: {triangles} triangles, {images} images, {path.stat().st_size / 1e6:.2f} MB")
    assert first[3] == 5
