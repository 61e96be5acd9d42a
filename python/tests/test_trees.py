"""Trees of species, presets, recipes, shapes and ages."""

import copy
import pickle

import numpy as np
import pytest
import treesynth


@pytest.fixture(scope="module")
def birch():
    return treesynth.grow("silver birch", height=4, seed=3)


def test_a_tree_in_five_lines(tmp_path, birch):
    path = tmp_path / "birch.glb"
    birch.save(path, 5_000, textures=128)
    assert path.read_bytes()[:4] == b"glTF"
    assert [entry.name for entry in tmp_path.iterdir()] == ["birch.glb"]
    assert birch.numbers["height"] == pytest.approx(4, abs=0.04)
    assert birch.skeleton.positions[:, 1].max() == pytest.approx(4, abs=0.04)


def test_skeletons_are_trees(birch):
    skeleton = birch.skeleton
    nodes = len(skeleton)
    assert skeleton.positions.shape == (nodes, 3) and skeleton.positions.dtype == np.float32
    assert skeleton.parents[0] == -1
    assert (skeleton.parents[1:] >= 0).all() and (skeleton.parents < np.arange(nodes)).all()
    assert (skeleton.radii > 0).all() and skeleton.orders.dtype == np.uint16
    assert set(skeleton.stages) <= set(range(5))


@pytest.mark.parametrize("field", ["positions", "parents", "radii", "orders", "stages", "hops"])
def test_arrays_are_views(birch, field):
    one, other = getattr(birch.skeleton, field), getattr(birch.skeleton, field)
    assert np.shares_memory(one, other)
    with pytest.raises(ValueError):
        one[0] = 1
    with pytest.raises(ValueError):
        one.flags.writeable = True


def test_arrays_outlive_their_owner():
    skeleton = treesynth.Skeleton([[0, 0, 0], [0, 1, 0]], [-1, 0], [0.1, 0.05])
    positions = skeleton.positions
    del skeleton
    filler = [treesynth.Skeleton([[9, 9, 9], [9, 8, 9]], [-1, 0]) for _ in range(1000)]
    assert positions.tolist() == [[0, 0, 0], [0, 1, 0]] and len(filler) == 1000


def test_same_seed_same_bits(birch):
    again = treesynth.Species.named("Betula pendula").grow(height=4, seed=3)
    assert again.skeleton == birch.skeleton
    other = treesynth.grow("silver birch", height=4, seed=4)
    assert other.skeleton != birch.skeleton


def test_what_can_be_pickled(birch):
    species = treesynth.Species.named("beech")
    recipe = treesynth.Recipe.preset("figure-06c", 2_000)
    for thing in [birch.skeleton, species, recipe]:
        assert pickle.loads(pickle.dumps(thing)) == thing
        assert copy.deepcopy(thing) == thing


def test_leaves_have_places(birch):
    leaves = birch.leaves[0]
    assert leaves.matrices.shape == (len(leaves), 4, 4)
    assert leaves.tints.shape == (len(leaves), 3) and leaves.area > 0
    corner = leaves.mesh.positions[-1]
    ends = leaves.matrices[:, :3, :3] @ corner + leaves.matrices[:, :3, 3]
    bearing = birch.skeleton.positions[leaves.nodes]
    assert np.linalg.norm(ends - bearing, axis=1).max() < 0.6


def test_assets_keep_budgets(birch):
    asset = birch.asset(4_000, textures=128, levels=2)
    assert asset.triangles[0] <= 4_000 and len(asset.triangles) == 3
    assert asset.triangles == sorted(asset.triangles, reverse=True)
    picture = asset.picture(96)
    assert picture.shape == (96, 96, 3) and picture.std() > 5
    assert asset.picture(64, transparent=True).shape == (64, 64, 4)
    assert len(asset.picture(64, level=2)) == 64
    with pytest.raises(treesynth.TreesynthError, match="level is 3, but must be 0 to 2"):
        asset.picture(64, level=3)


@pytest.mark.parametrize("ending", ["glb", "obj", "ply", "stl", "usdz", "usda", "png"])
def test_every_file(tmp_path, birch, ending):
    birch.save(tmp_path / f"a tree.{ending}", 3_000, textures=128, wind=True, levels=2)
    assert (tmp_path / f"a tree.{ending}").stat().st_size > 1000
    assert not [entry for entry in tmp_path.iterdir() if entry.name.startswith(".")]


def test_meshes(birch):
    mesh = birch.skeleton.mesh(6)
    assert mesh.triangles.max() < len(mesh.positions) and mesh.triangles.shape[1] == 3
    assert np.allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-3)
    with pytest.raises(ValueError):
        mesh.triangles[0, 0] = 1
    trunk = treesynth.Skeleton([[0, 0, 0], [0, 1, 0]], [-1, 0], [0.1, 0.05])
    assert trunk.closed_mesh().positions[:, 1].max() > 0.9


def test_presets_and_recipes():
    tree = treesynth.grow("figure-06c", nodes=2_000, season="autumn")
    assert len(tree.skeleton) > 50 and len(tree.leaves) == 1
    recipe = treesynth.Recipe.preset("figure-06c", 2_000)
    skeleton = recipe.grow()
    assert skeleton.relaxed() == tree.skeleton
    assert treesynth.Recipe.from_json(recipe.to_json()) == recipe
    data = recipe.data
    data["seed"] = 5
    assert treesynth.Recipe.from_data(data).seed == 5
    with pytest.raises(treesynth.TreesynthError, match="unknown field"):
        treesynth.Recipe.from_data(data | {"nonsense": 1})


def test_shapes_are_filled(tmp_path):
    (tmp_path / "heart.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg"><path d="M5 9 C-3 3 2 -1 5 2 C8 -1 13 3 5 9Z"/></svg>'
    )
    tree = treesynth.fill(tmp_path / "heart.svg", nodes=300, height=3)
    assert tree.skeleton.positions[:, 1].max() == pytest.approx(3.5, abs=0.3)
    assert tree.numbers["nodes"] > 250
    with pytest.raises(treesynth.TreesynthError, match="up goes with a mesh file"):
        treesynth.fill(tmp_path / "heart.svg", up="z")
    with pytest.raises(OSError, match="none.obj"):
        treesynth.fill("none.obj")


def test_trees_over_the_years():
    growth = treesynth.Growth("growth-15-cottonwood")
    young, old = growth.at(3), growth.at(growth.years)
    assert len(young.skeleton) < len(old.skeleton)
    with pytest.raises(treesynth.TreesynthError, match="age"):
        growth.at(growth.years + 1)


def test_names():
    names = treesynth.names()
    assert len({entry["name"] for entry in names}) == len(names)
    assert {"name": "beech", "system": "species"}.items() <= next(e for e in names if e["name"] == "beech").items()
    assert {entry["system"] for entry in treesynth.names("growth")} == {"growth"}
    with pytest.raises(treesynth.TreesynthError, match="system is 'x'|system is \"x\""):
        treesynth.names("x")


def test_a_species_of_ones_own():
    text = treesynth.Species.named("hazel").to_text().replace('name = "hazel"', 'name = "my shrub"')
    species = treesynth.Species.parse(text)
    assert species.name == "my shrub" and species.data["name"] == "my shrub"
    assert len(species.grow(height=3).skeleton) > 100
    with pytest.raises(treesynth.TreesynthError, match="line 2"):
        treesynth.Species.parse('name = "x"\nnonsense = 1')


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: treesynth.grow("silver brich"), "silver birch"),
        (lambda: treesynth.grow("oak", height=60), "height of English oak is 60 m, but must be"),
        (lambda: treesynth.grow("oak", nodes=100), "nodes goes with presets"),
        (lambda: treesynth.grow("figure-06c", height=3), "height goes with species"),
        (lambda: treesynth.grow("figure-06c", season="spring"), "season is"),
        (lambda: treesynth.grow("figure-06c", nodes=0), "is 0, but must be"),
        (lambda: treesynth.grow("stand-generations"), "treesynth.Forest"),
        (lambda: treesynth.grow("variational-14-oak"), "treesynth.fill"),
        (lambda: treesynth.grow("growth-15-cottonwood"), "treesynth.Growth"),
        (lambda: treesynth.Recipe.preset("beech"), "system species, not guided"),
        (lambda: treesynth.Skeleton([[0, 0], [1, 1]], [-1, 0]), r"positions has the shape \[2, 2\]"),
        (lambda: treesynth.Skeleton([[0, 0, 0], [1, 1, 1]], [-1, 1]), "parent"),
        (lambda: treesynth.Skeleton([[0, 0, 0], [1, 1, 1]], [-1, -2]), "parents has -2"),
        (lambda: treesynth.Skeleton([[0, 0, 0], [0, np.nan, 0]], [-1, 0]), "finite"),
        (lambda: treesynth.Skeleton([[0, 0, 0], [0, 1, 0]], [-1, 0], [0.1]), "radii"),
        (lambda: treesynth.Skeleton([[0, 0, 0], [0, 1, 0]], [-1, 0], orders=[0, 70_000]), "orders is 70000"),
    ],
)
def test_what_is_refused(call, words):
    with pytest.raises(treesynth.TreesynthError, match=words):
        call()


def test_refused_files_leave_nothing(tmp_path, birch):
    with pytest.raises(treesynth.TreesynthError, match="must end in .glb"):
        birch.save(tmp_path / "tree.fbx")
    with pytest.raises(OSError, match="nowhere"):
        birch.save(tmp_path / "nowhere" / "tree.glb", 3_000, textures=128)
    with pytest.raises(treesynth.TreesynthError, match="up is"):
        birch.save(tmp_path / "tree.obj", 3_000, textures=128, up="x")
    with pytest.raises(treesynth.TreesynthError, match="textures is 100, but must be"):
        birch.save(tmp_path / "tree.obj", 3_000, textures=100)
    assert not list(tmp_path.iterdir())


def test_images_are_jpeg_or_png(tmp_path, birch):
    sizes = {}
    for images in ["jpeg", "png"]:
        path = tmp_path / f"{images}.glb"
        birch.save(path, 4_000, textures=256, images=images)
        data = path.read_bytes()
        sizes[images] = len(data)
        assert (b"image/jpeg" in data) == (images == "jpeg") and b"image/png" in data
    assert sizes["jpeg"] < sizes["png"]
    with pytest.raises(treesynth.TreesynthError, match="images"):
        birch.save(tmp_path / "bad.glb", 4_000, textures=128, images="gif")


def test_dead_and_broken_trees(birch):
    dead = treesynth.grow("silver birch", height=4, seed=3, years_dead=8)
    assert not dead.leaves and dead.numbers["dead"] == 8
    broken = treesynth.grow("silver birch", height=4, seed=3, storm_damage=0.5)
    assert len(broken.skeleton) < len(birch.skeleton)
    dead.asset(2_000, textures=None)
    with pytest.raises(treesynth.TreesynthError, match="storm|damage"):
        treesynth.grow("silver birch", storm_damage=2)
