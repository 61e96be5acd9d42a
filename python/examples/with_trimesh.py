"""A bare tree in trimesh: watertight, with volume and mass. pip install trimesh"""

import treesynth
import trimesh

tree = treesynth.grow("figure-06b", nodes=2_000)
surface = tree.skeleton.closed_mesh()
mesh = trimesh.Trimesh(surface.positions, surface.triangles, process=False)
print(f"watertight: {mesh.is_watertight}, volume: {1000 * mesh.volume:.2f} litres, {mesh.body_count} body")
assert mesh.is_watertight

# A model with its images, read back as a scene.
tree.save("tree.glb", 5_000)
print(trimesh.load("tree.glb").geometry.keys())
