"""trimesh loads every format of every tree named by its figures (NAME.stats.json): the counts are those written."""

import json
import sys
import xml.etree.ElementTree as xml
from pathlib import Path

import trimesh


def faces(path):
    """Triangles of all copies of all meshes in a file."""
    scene = trimesh.load_scene(path, process=False)
    return sum(len(scene.geometry[scene.graph[node][1]].faces) for node in scene.graph.nodes_geometry)


def check(stats):
    figures = json.loads(stats.read_text())
    parts = figures["parts"]
    name = figures["name"]
    triangles = sum(part["triangles"] for part in parts.values())
    vertices = sum(part["vertices"] for part in parts.values())
    loaded = {}
    for extension, expected in [("obj", triangles), ("ply", triangles), ("stl", triangles),
                                ("nodes.glb", triangles), ("glb", triangles)]:
        path = stats.with_name(f"{name}.{extension}")
        found = faces(path)
        assert found == expected, f"{path}: {found} triangles of {expected}"
        loaded[extension] = found
    ply = trimesh.load(stats.with_name(f"{name}.ply"), process=False)
    assert len(ply.vertices) == vertices, f"{name}.ply: {len(ply.vertices)} vertices of {vertices}"
    drawing = xml.parse(stats.with_name(f"{name}.svg")).getroot()
    paths = len(drawing.findall(".//{http://www.w3.org/2000/svg}path"))
    internodes = figures["metrics"]["nodes"] - 1
    assert paths == internodes, f"{name}.svg: {paths} lines of {internodes}"
    return triangles


total = [check(Path(path)) for path in sys.argv[1:]]
assert total, "no trees named"
print(f"{len(total)} trees, {sum(total)} triangles, each in OBJ, PLY, STL and GLB, and its lines in SVG: all there")
