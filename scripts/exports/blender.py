"""Blender imports a tree's GLB, finds what was written, and Cycles renders it."""

import json
import math
import sys

import bpy

name, picture = sys.argv[1:]
parts = json.load(open(f"{name}.stats.json"))["parts"]
for extension in ["glb", "nodes.glb"]:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=f"{name}.{extension}")
    triangles, copies = 0, 0
    for instance in bpy.context.evaluated_depsgraph_get().object_instances:
        mesh = instance.object.data
        if instance.object.type == "MESH":
            copies += 1
            triangles += len(mesh.polygons)
    expected = sum(part["triangles"] for part in parts.values())
    print(f"{extension}: {copies} objects, {triangles} triangles of {expected}")
    assert triangles == expected
    assert all(not m.node_tree or m.node_tree.nodes for m in bpy.data.materials) and len(bpy.data.materials) == len(parts)
    if extension == "glb":
        scene = bpy.context.scene
        scene.view_settings.view_transform = "Standard"
        scene.render.engine, scene.cycles.samples, scene.cycles.device = "CYCLES", 16, "CPU"
        scene.render.resolution_x = scene.render.resolution_y = 400
        scene.world = bpy.data.worlds.new("sky")
        scene.world.color = (0.5, 0.55, 0.6)
        sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
        sun.data.energy, sun.rotation_euler = 4.0, (0.7, 0.3, 0.5)
        camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        camera.location, camera.rotation_euler = (0.0, -24.0, 6.0), (math.radians(90), 0.0, 0.0)
        for item in [sun, camera]:
            scene.collection.objects.link(item)
        scene.camera = camera
        scene.render.filepath = picture
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(picture)
        tones = image.pixels[:][0::4]
        assert max(tones) - min(tones) > 0.3, "the picture is blank"
print(f"rendered to {picture}")
