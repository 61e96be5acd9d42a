"""Botanical trees: branching structure, thickness, surface, leaves, files and pictures.

>>> import treesynth
>>> tree = treesynth.grow("silver birch", height=6, seed=3)
>>> tree.skeleton.positions.shape[1]
3
>>> tree.save("birch.glb", 10_000)

Names are those of ``treesynth.names()``. Lengths are metres, +Y is up, days are those of the northern half of the Earth. The same
seed gives the same bits on every platform.
"""

from ._treesynth import (
    Asset,
    Cloud,
    Example,
    Forest,
    Growth,
    Landscape,
    Leaves,
    Mesh,
    Recipe,
    ReconstructedStand,
    Reconstruction,
    Scan,
    Skeleton,
    Species,
    Tile,
    Tree,
    TreesynthError,
    __version__,
    fill,
    grow,
    names,
    read_trees,
    reconstruct,
    reconstruct_stand,
    scan,
    write_tileset,
)

__all__ = [
    "Asset",
    "Cloud",
    "Example",
    "Forest",
    "Growth",
    "Landscape",
    "Leaves",
    "Mesh",
    "Recipe",
    "ReconstructedStand",
    "Reconstruction",
    "Scan",
    "Skeleton",
    "Species",
    "Tile",
    "Tree",
    "TreesynthError",
    "__version__",
    "fill",
    "grow",
    "names",
    "read_trees",
    "reconstruct",
    "reconstruct_stand",
    "scan",
    "write_tileset",
]
