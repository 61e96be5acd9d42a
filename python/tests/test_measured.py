"""Formats of plant science, scans, reconstruction."""

import numpy as np
import pytest
import treesynth


@pytest.fixture(scope="module")
def tree():
    return treesynth.grow("wild cherry", height=6, seed=2, day=20)


@pytest.mark.parametrize("ending", ["json", "swc", "csv", "mtg"])
def test_skeletons_come_back(tmp_path, tree, ending):
    path = tmp_path / f"tree.{ending}"
    tree.skeleton.save(path)
    trees, offset = treesynth.read_trees(path)
    assert len(trees) == 1 and list(offset) == [0, 0, 0]
    back = trees[0]
    # Some formats tell nodes in another order.
    order, other = np.lexsort(tree.skeleton.positions.T), np.lexsort(back.positions.T)
    if ending != "csv":
        assert np.allclose(back.positions[other], tree.skeleton.positions[order], atol=1e-4)
    assert back.diameter_at(1.3) == pytest.approx(tree.skeleton.diameter_at(1.3), rel=0.02)
    assert back.metrics()["height"] == pytest.approx(6, abs=0.06)


def test_axes_units_offsets(tmp_path, tree):
    path = tmp_path / "tree.swc"
    tree.skeleton.save(path, up="z", unit=0.01, offset=(1e6, 2e6, 0))
    trees, offset = treesynth.read_trees(path, up="z", unit=0.01, offset=(1e6, 2e6, 0))
    assert trees[0].metrics()["height"] == pytest.approx(6, abs=0.06)
    assert list(offset) == [1e6, 2e6, 0]
    with pytest.raises(treesynth.TreesynthError, match="unit is 0"):
        treesynth.read_trees(path, unit=0)
    with pytest.raises(treesynth.TreesynthError, match="must end in"):
        treesynth.read_trees(tmp_path / "tree.doc")
    with pytest.raises(FileNotFoundError, match="none.swc"):
        treesynth.read_trees(tmp_path / "none.swc")


def test_a_tree_is_scanned_and_made_again(tmp_path, tree):
    scan = treesynth.scan(tree, distance=8, step=0.002, noise=0.001)
    cloud = scan.cloud
    assert len(cloud) == len(scan.is_wood) == len(scan.nodes) and scan.is_wood.all()
    assert scan.nodes.max() < len(tree.skeleton)
    cloud.save(tmp_path / "cloud.ply")
    assert len(treesynth.Cloud.open(tmp_path / "cloud.ply")) == len(cloud)
    made = treesynth.reconstruct(cloud)
    assert made.is_measured.any() and len(made.is_measured) == len(made.skeleton)
    assert made.skeleton.diameter_at(1.3) == pytest.approx(tree.skeleton.diameter_at(1.3), abs=0.01)
    assert made.skeleton.metrics()["height"] == pytest.approx(6, abs=0.3)


def test_clouds_of_arrays():
    points = np.random.default_rng(1).uniform(0, 1, (1000, 3)) + [478_000, 5_500_000, 300]
    cloud = treesynth.Cloud(points)
    assert cloud.points.max() < 2_000 and cloud.offset[0] > 400_000
    assert len(cloud.thinned(0.5)) <= 27
    for bad, words in [
        (points[:, :2], r"points has the shape \[1000, 2\]"),
        (np.full((3, 3), np.nan), "finite|NaN"),
    ]:
        with pytest.raises(treesynth.TreesynthError, match=words):
            treesynth.Cloud(bad)
    for few in [points[:0], points[:1], np.zeros((50, 3))]:
        with pytest.raises(treesynth.TreesynthError):
            treesynth.reconstruct(treesynth.Cloud(few))


def test_leaves_are_set_aside_and_twigs_made_up():
    tree = treesynth.grow("ash", height=4, seed=2, day=200)
    scan = treesynth.scan(tree, distance=5, step=0.002)
    made = treesynth.reconstruct(scan.cloud, set_leaves_aside=True)
    assert len(made.is_wood) == len(made.is_leaf) == len(scan.cloud)
    assert not (made.is_wood & made.is_leaf).any()
    right = (made.is_wood[scan.is_wood].mean() + made.is_leaf[~scan.is_wood].mean()) / 2
    assert right > 0.7
    plain = treesynth.reconstruct(scan.cloud)
    assert not plain.is_leaf.any()
    whole, measured = plain.completed(seed=3)
    assert measured == len(plain.skeleton) < len(whole)
    assert np.array_equal(whole.positions[:measured], plain.skeleton.positions)
    assert np.array_equal(whole.radii[:measured], plain.skeleton.radii)
    with pytest.raises(treesynth.TreesynthError, match="thickest"):
        plain.completed(thickest=0)


def test_a_stand_is_made_again(tree):
    points = treesynth.scan(tree, distance=8, step=0.002).cloud.points
    both = np.concatenate([points, points + [6, 0, 0]])
    cloud = treesynth.Cloud(both, up="y")
    stand = treesynth.reconstruct_stand(cloud)
    assert len(stand) == len(stand.trees) == 2 and len(stand.owners) == len(both)
    assert set(np.unique(stand.owners)) <= {-1, 0, 1} and stand.is_wood.mean() > 0.8
    for one in stand.trees:
        assert one.skeleton.diameter_at(1.3) == pytest.approx(tree.skeleton.diameter_at(1.3), abs=0.01)
    told = treesynth.reconstruct_stand(cloud, bases=[[0, 0, 0], [6, 0, 0]])
    assert len(told) == 2
    with pytest.raises(treesynth.TreesynthError, match="bases"):
        treesynth.reconstruct_stand(cloud, bases=[[0, 0, 0], [0, 0, 0]])


def test_more_trees_of_a_kind(tree):
    example = treesynth.Example(tree.skeleton)
    assert example.trunk["diameter"] > 0 and example.orders[1]["count"] > 3
    one, other = example.grow(4_000, seed=1), example.grow(4_000, seed=2)
    assert one != other and example.grow(4_000, seed=1) == one
    tuned = example.tuned(4_000, trials=2).grow(4_000, seed=1)
    assert tuned.metrics()["height"] == pytest.approx(6, rel=0.3)
    with pytest.raises(treesynth.TreesynthError, match="branches"):
        treesynth.Example(treesynth.Skeleton([[0, 0, 0], [0, 1, 0]], [-1, 0]))
