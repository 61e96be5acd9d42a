"""Blender imports a GLB with images and holes, finds them in its materials, and Cycles renders it."""

import math
import sys

import bpy
from mathutils import Vector

glb, picture = sys.argv[1:3]
side = int(sys.argv[3]) if len(sys.argv) > 3 else 800
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=glb)
meshes = [item for item in bpy.data.objects if item.type == "MESH"]
# Of levels the finest is shown.
shown = [item for item in meshes if "_lod" not in item.name and not (item.parent and "_lod" in item.parent.name)]
for item in meshes:
    item.hide_render = item not in shown
for item in shown:
    material = item.data.materials[0]
    nodes = material.node_tree.nodes
    images = {node.image.name: tuple(node.image.size) for node in nodes if node.type == "TEX_IMAGE"}
    surface = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    holes = surface.inputs["Alpha"].is_linked
    print(f"{item.name}: {len(item.data.polygons)} triangles, {material.name}, {images}, holes: {holes}")
    assert images and all(min(size) > 1 for size in images.values()), "no images"
    assert surface.inputs["Base Color"].is_linked and surface.inputs["Normal"].is_linked
    assert holes == material.name.startswith("cards"), "cards have holes, and nothing else has"
corners = [item.matrix_world @ Vector(corner) for item in shown for corner in item.bound_box]
low, high = [Vector([f(c[i] for c in corners) for i in range(3)]) for f in (min, max)]
middle, size = (low + high) / 2, max(high - low)
scene = bpy.context.scene
scene.view_settings.view_transform = "Standard"
scene.render.engine, scene.cycles.samples, scene.cycles.device = "CYCLES", 24, "CPU"
scene.cycles.transparent_max_bounces = 32
scene.render.resolution_x = scene.render.resolution_y = side
scene.world = bpy.data.worlds.new("sky")
scene.world.color = (0.55, 0.62, 0.7)
sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
sun.data.energy, sun.rotation_euler = 4.0, (0.7, 0.3, 0.5)
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
camera.data.angle = math.radians(35)
camera.location = middle + Vector((0, -1.75 * size, 0))
camera.rotation_euler = (math.radians(90), 0, 0)
for item in [sun, camera]:
    scene.collection.objects.link(item)
scene.camera = camera
scene.render.filepath = picture
bpy.ops.render.render(write_still=True)
tones = bpy.data.images.load(picture).pixels[:][1::4]
assert max(tones) - min(tones) > 0.3, "the picture is blank"
print(f"rendered to {picture}")
