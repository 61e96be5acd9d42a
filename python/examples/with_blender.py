"""A tree in Blender, its leaves as instances of one mesh. pip install bpy, or run it in Blender's own Python."""

import bpy
import treesynth
from mathutils import Matrix

# Blender is +Z up.
up = Matrix(((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1)))


def add(mesh, name):
    data = bpy.data.meshes.new(name)
    data.from_pydata(mesh.positions.tolist(), [], mesh.triangles.tolist())
    return data


tree = treesynth.grow("silver birch", height=6, seed=3)
bark = bpy.data.objects.new("bark", add(tree.skeleton.mesh(), "bark"))
bark.matrix_world = up
bpy.context.scene.collection.objects.link(bark)
for leaves in tree.leaves:
    data = add(leaves.mesh, "leaf")
    for matrix in leaves.matrices:
        leaf = bpy.data.objects.new("leaf", data)
        leaf.matrix_world = up @ Matrix(matrix.tolist())
        bpy.context.scene.collection.objects.link(leaf)
bpy.ops.wm.save_as_mainfile(filepath="birch.blend")
print(len(bpy.data.objects), "objects,", len(bpy.data.meshes), "meshes")
