"""trimesh takes the closed surface of each tree named (NAME.ply) for one solid, of the volume of the skeleton
(NAME.json).

The skeleton's volume is that of the union of its cones, each with a ball at its ends: the volumes of all, each point counted
once however many it lies in, by random points (Monte Carlo).
"""

import json
import sys
from pathlib import Path

import numpy as np
import trimesh

POINTS = 40_000
# Range of the volume over the skeleton's: polygons at two voxels per radius and more cut corners, blends of half a radius add.
LEAST, MOST = 0.94, 1.12


def cones(path):
    """Starts, ends, and radii at both."""
    tree = json.loads(path.read_text())
    positions, radii, orders = (np.array(tree[key]) for key in ["positions", "radii", "orders"])
    child = np.arange(1, len(positions))
    parent = np.array(tree["parents"][1:])
    # A branch's first internode has its own radius, but the root's branches have the root's.
    off = (orders[child] != orders[parent]) & (parent != 0)
    return positions[parent], positions[child], np.where(off, radii[child], radii[parent]), radii[child]


def inside(points, start, end, first, last):
    """True where a point lies in a cone: one row per point."""
    way = end - start
    square = np.maximum((way * way).sum(axis=1), 1e-30)
    along = np.clip((points @ way.T - (start * way).sum(axis=1)) / square, 0, 1)
    away = points[:, None, :] - (start + along[:, :, None] * way)
    radius = first + along * (last - first)
    return (away * away).sum(axis=2) <= radius * radius


def union(path):
    start, end, first, last = cones(path)
    random = np.random.default_rng(1)
    thick = np.maximum(first, last)
    length = np.linalg.norm(end - start, axis=1)
    # Points are drawn in a cylinder around each cone.
    cylinders = np.pi * thick**2 * (length + 2 * thick)
    drawn = random.choice(len(length), POINTS, p=cylinders / cylinders.sum())
    axis = (end - start)[drawn] / np.maximum(length[drawn], 1e-12)[:, None]
    helper = np.where(np.abs(axis[:, :1]) > 0.9, [[0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0]])
    side = np.cross(axis, helper)
    side /= np.linalg.norm(side, axis=1)[:, None]
    angle = random.uniform(0, 2 * np.pi, POINTS)
    out = thick[drawn] * np.sqrt(random.uniform(0, 1, POINTS))
    along = random.uniform(0, 1, POINTS) * (length + 2 * thick)[drawn] - thick[drawn]
    points = start[drawn] + axis * along[:, None]
    points += side * (out * np.cos(angle))[:, None] + np.cross(axis, side) * (out * np.sin(angle))[:, None]
    total = 0.0
    for chunk in np.array_split(np.arange(POINTS), max(1, POINTS * len(length) // 2_000_000)):
        within = inside(points[chunk], start, end, first, last)
        own = within[np.arange(len(chunk)), drawn[chunk]]
        total += (own / np.maximum(within.sum(axis=1), 1)).sum()
    return cylinders.sum() * total / POINTS


whole = 0
for path in map(Path, sys.argv[1:]):
    mesh = trimesh.load(path, process=False)
    assert mesh.is_watertight and mesh.is_winding_consistent, f"{path}: not watertight"
    bodies = mesh.body_count
    assert bodies == 1, f"{path}: {bodies} bodies"
    # Each place where branches touch again is a handle, which takes 2 away.
    euler = mesh.euler_number
    assert euler % 2 == 0 and euler <= 2, f"{path}: Euler characteristic {euler}"
    whole += euler == 2
    volume, expected = mesh.volume, union(path.with_suffix(".json"))
    ratio = volume / expected
    print(f"{path.stem}: {len(mesh.faces)} triangles, Euler characteristic {euler}, "
          f"{volume:.5f} m³, the skeleton's {expected:.5f}, ratio {ratio:.3f}")
    assert LEAST < ratio < MOST, f"{path}: the volume is {ratio:.3f} of the skeleton's"
assert whole, "in every tree branches touch again"
print(f"{len(sys.argv) - 1} closed surfaces: all watertight and one body, {whole} of Euler characteristic 2")
