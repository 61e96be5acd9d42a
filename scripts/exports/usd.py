"""USD's own library opens every stage of a folder, finds what the GLB beside it has, and has nothing against it."""

import json
import struct
import sys
from pathlib import Path

from pxr import Usd, UsdGeom, UsdShade, UsdValidation

folder = Path(sys.argv[1])


def triangles_of_glb(path):
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    gltf = json.loads(data[20:20 + length])
    meshes = [sum(gltf["accessors"][p["indices"]]["count"] // 3 for p in mesh["primitives"]) for mesh in gltf["meshes"]]
    return sum(meshes[node["mesh"]] for node in gltf["nodes"] if "mesh" in node)


def triangles(stage):
    """Of all copies; instances of whole trees too."""
    total = 0
    for prim in stage.Traverse(Usd.TraverseInstanceProxies()):
        if prim.IsA(UsdGeom.PointInstancer):
            copies = UsdGeom.PointInstancer(prim)
            targets = copies.GetPrototypesRel().GetTargets()
            # Within an instance of a tree the relationship points into its prototype.
            mesh = UsdGeom.Mesh(stage.GetPrimAtPath(targets[0]))
            assert mesh, f"{prim.GetPath()}: no prototype at {targets}"
            each = len(mesh.GetFaceVertexCountsAttr().Get())
            count = len(copies.GetProtoIndicesAttr().Get())
            for attribute in [copies.GetPositionsAttr(), copies.GetOrientationsAttr(), copies.GetScalesAttr()]:
                assert len(attribute.Get()) == count
            total += count * each
        elif prim.IsA(UsdGeom.Mesh) and not prim.GetParent().IsA(UsdGeom.PointInstancer):
            total += len(UsdGeom.Mesh(prim).GetFaceVertexCountsAttr().Get())
    return total


def bounds(stage):
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_])
    box = cache.ComputeWorldBound(stage.GetDefaultPrim()).ComputeAlignedRange()
    unit = UsdGeom.GetStageMetersPerUnit(stage)
    size = box.GetSize() * unit
    return sorted([round(x, 2) for x in size])


one, all_trees = (triangles_of_glb(folder / f"{name}.glb") for name in ["merged", "scene-merged"])
expected = {"parts": one, "axes": one, "plain": one, "levels": one, "seasons": one, "scene": all_trees}
bad = 0
boxes = {}
for path in sorted(folder.glob("*.usd[az]")):
    stage = Usd.Stage.Open(str(path))
    found = triangles(stage)
    assert found == expected[path.stem], f"{path}: {found} triangles of {expected[path.stem]}"
    boxes[path.stem] = bounds(stage)
    for prim in stage.Traverse():
        if prim.IsA(UsdGeom.Mesh):
            material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()
            assert material, f"{path}: {prim.GetPath()} has no material"
    if path.stem == "axes":
        assert UsdGeom.GetStageUpAxis(stage) == "Z" and UsdGeom.GetStageMetersPerUnit(stage) == 0.01
    if path.stem == "seasons":
        seasons = stage.GetDefaultPrim().GetVariantSet("season")
        assert seasons.GetVariantNames() == ["summer", "winter"]
        seasons.SetVariantSelection("winter")
        assert 0 < triangles(stage) < found
    # All rules of usdchecker.
    rules = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    for issue in UsdValidation.ValidationContext(rules).Validate(Usd.Stage.Open(str(path))):
        print(f"{path.name}: {issue.GetErrorAsString()}", file=sys.stderr)
        bad += 1
assert boxes, "no stages"
assert boxes["axes"] == boxes["parts"], boxes
print(f"{len(list(folder.glob('*.usd[az]')))} stages, {one} triangles a tree; USD's checker complained {bad} times")
sys.exit(bad > 0)
