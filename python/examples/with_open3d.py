"""A simulated scan of a tree in Open3D, and the skeleton made of it as lines. pip install open3d"""

import open3d
import treesynth

tree = treesynth.grow("wild cherry", height=6, seed=2, day=20)
scan = treesynth.scan(tree, distance=8, step=0.002)
points = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(scan.cloud.points))
made = treesynth.reconstruct(scan.cloud).skeleton
lines = open3d.geometry.LineSet(
    open3d.utility.Vector3dVector(made.positions),
    open3d.utility.Vector2iVector([(parent, node) for node, parent in enumerate(made.parents) if parent >= 0]),
)
open3d.io.write_point_cloud("scan.ply", points)
open3d.io.write_line_set("skeleton.ply", lines)
print(points, lines)
