"""Landscapes by tiles: the same bytes wherever a tile is made, and nothing lost or made twice where workers die."""

import importlib.util
import json
import os
import pathlib
import pickle
import signal
import subprocess
import sys

import numpy as np
import pytest
import treesynth

EXAMPLE = pathlib.Path(__file__).parent.parent / "examples" / "landscape_on_ray.py"
SEASONS = 8


def driver():
    spec = importlib.util.spec_from_file_location("landscape_on_ray", EXAMPLE)
    module = importlib.util.module_from_spec(spec)
    sys.modules["landscape_on_ray"] = module
    spec.loader.exec_module(module)
    return module


def small():
    x, z = np.meshgrid(np.arange(16.0), np.arange(16.0))
    return treesynth.Landscape(
        ["stand-decurrent", "stand-excurrent"],
        seed=7,
        tile=3,
        margin=2,
        heights=0.5 * x - 0.2 * z,
        planting=(x > 7).astype(int),
        density=np.full((16, 16), 0.8),
        corner=(-16, -16),
        step=2.0,
    )


def files(folder):
    return {file.name: file.read_bytes() for file in sorted((folder / "tiles").iterdir())}


def test_a_tile_stands_on_its_ground_and_is_planted_by_the_map():
    landscape = small()
    assert landscape.species == ["stand-decurrent", "stand-excurrent"] and landscape.side == 6
    tile = landscape.grow(0, 0, SEASONS)
    places = tile.places
    assert 4 <= len(places) <= 9 and len(tile.trees) == len(places) and tile.metamers > 100
    assert ((places[:, [0, 2]] >= 0) & (places[:, [0, 2]] < 6)).all()
    # Half a metre up for each field of two metres along x, a fifth down along z.
    wanted = 0.25 * (places[:, 0] + 16) - 0.1 * (places[:, 2] + 16)
    assert np.abs(places[:, 1] - wanted).max() < 1e-3
    # Beyond the maps there is nothing.
    empty = landscape.grow(50, 0, 1)
    assert len(empty.places) == 0


def test_a_landscape_is_saved_and_pickled():
    landscape = small()
    for other in [treesynth.Landscape.from_json(landscape.to_json()), pickle.loads(pickle.dumps(landscape))]:
        assert other.to_json() == landscape.to_json()
        assert (other.grow(1, 0, 4).places == landscape.grow(1, 0, 4).places).all()
    own = treesynth.Landscape([("mine", {"length": 0.1, "shade_tolerance": 0.5})], tile=2, margin=0)
    assert own.species == ["mine"] and own.grow(0, 0, 3).metamers > 10


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"species": []}, "species"),
        ({"species": ["no such stand"]}, "no such stand"),
        ({"species": [("mine", {"no_option": 1})]}, "no_option"),
        ({"spacing": 0.0}, "Landscape.spacing"),
        ({"tile": 0}, "Landscape.tile"),
        ({"planting": [[2]]}, "planting has 2"),
        ({"density": [[1.5]]}, "PlantingMap.density"),
        ({"planting": [[0, 0]], "density": [[1.0]]}, "density"),
        ({"planting": np.zeros((0, 0), int)}, "PlantingMap.columns"),
        ({"heights": [[float("nan")]]}, "Heightmap.heights"),
        ({"heights": [[1.0]], "step": -1.0}, "Heightmap.spacing"),
    ],
)
def test_impossible_landscapes_are_refused(options, words):
    with pytest.raises(treesynth.TreesynthError, match=words):
        treesynth.Landscape(**({"species": ["stand-decurrent"]} | options))


def test_files_are_whole_and_tell_where_they_stand(tmp_path):
    tile = small().grow(0, 0, SEASONS)
    (low, high), (near_error, far_error) = tile.save_models(tmp_path / "n.glb", tmp_path / "f.glb", error=0.005)
    places = tile.places - np.array(tile.origin)
    assert (places > low).all() and (places < high).all() and 0 < near_error < far_error
    sizes = [(tmp_path / name).stat().st_size for name in ["n.glb", "f.glb"]]
    assert sizes[1] < 0.3 * sizes[0], sizes
    entries = [("n.glb", "f.glb", tile.origin, (low, high), (near_error, far_error))]
    treesynth.write_tileset(tmp_path / "tileset.json", entries, position=(9.9, 51.5, 200))
    root = json.loads((tmp_path / "tileset.json").read_text())["root"]
    [far] = root["children"]
    assert far["content"]["uri"] == "f.glb" and far["children"][0]["content"]["uri"] == "n.glb"
    assert far["geometricError"] == far_error and len(root["transform"]) == 16
    with pytest.raises(treesynth.TreesynthError, match="latitude"):
        treesynth.write_tileset(tmp_path / "other.json", entries, position=(0, 91, 0))
    with pytest.raises(treesynth.TreesynthError, match="TileModel.finer"):
        treesynth.write_tileset(tmp_path / "other.json", [(*entries[0][:4], (0.2, 0.1))])
    with pytest.raises(treesynth.TreesynthError, match="error is 1, but"):
        tile.save_models(tmp_path / "other.glb", tmp_path / "f.glb", error=1.0)
    with pytest.raises(treesynth.TreesynthError, match=".parquet"):
        tile.save_table(tmp_path / "table.csv")
    assert not (tmp_path / "other.json").exists()


def test_the_table_has_the_trees(tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    tile = small().grow(0, 0, SEASONS)
    tile.save_table(tmp_path / "t.parquet")
    table = parquet.read_table(tmp_path / "t.parquet").to_pydict()
    assert np.array_equal(np.array([table["x"], table["y"], table["z"]]).T, tile.places)
    heights = [tree.metrics()["height"] for tree in tile.trees]
    assert table["height"] == heights and sum(table["metamers"]) == tile.metamers
    diameters = [tree.diameter_at(1.3) for tree in tile.trees]
    assert table["breast_height_diameter"] == diameters
    assert set(table["species"]) <= {"stand-decurrent", "stand-excurrent"} and not any(table["is_dead"])


def test_another_process_makes_the_same_bytes(tmp_path):
    make_tile = driver().make_tile
    for name in ["here", "there"]:
        (tmp_path / name / "tiles").mkdir(parents=True)
    make_tile(small(), "job", 0, -1, SEASONS, 0.02, str(tmp_path / "here"))
    (tmp_path / "landscape").write_bytes(pickle.dumps(small()))
    program = (
        "import pickle, sys; sys.path.insert(0, sys.argv[1]); import landscape_on_ray;"
        "landscape_on_ray.make_tile(pickle.load(open(sys.argv[2], 'rb')), 'job', 0, -1, int(sys.argv[4]), 0.02, sys.argv[3])"
    )
    arguments = [str(EXAMPLE.parent), str(tmp_path / "landscape"), str(tmp_path / "there"), str(SEASONS)]
    environment = os.environ | {"RAYON_NUM_THREADS": "1"}
    subprocess.run([sys.executable, "-c", program, *arguments], check=True, env=environment)
    assert files(tmp_path / "here") == files(tmp_path / "there")


def test_a_cluster_that_loses_workers_makes_the_same_bytes(tmp_path):
    ray = pytest.importorskip("ray")
    module = driver()
    tiles = [(x, z) for x in range(-1, 2) for z in range(-1, 1)]
    plain = tmp_path / "plain"
    (plain / "tiles").mkdir(parents=True)

    def dying(landscape, job, x, z, seasons, error, folder):
        """Two tiles kill their workers the first time: one before any file, one after all but the last."""
        log = pathlib.Path(folder) / "log"
        log.mkdir(exist_ok=True)
        tries = len(list(log.glob(f"{x}_{z}.*")))
        (log / f"{x}_{z}.{tries}").touch()
        if tries == 0 and (x, z) == (0, 0):
            os.kill(os.getpid(), signal.SIGKILL)
        if tries == 0 and (x, z) == (1, -1):
            kill = lambda path, text: os.kill(os.getpid(), signal.SIGKILL)  # noqa: E731
            module.make_tile.__globals__["write_whole"] = kill
        return module.make_tile(landscape, job, x, z, seasons, error, folder)

    # Workers do not know where the example is.
    ray.cloudpickle.register_pickle_by_value(module)
    ray.init(num_cpus=2, log_to_driver=False, include_dashboard=False)
    try:
        told = []
        many = tmp_path / "many"

        class Stop(Exception):
            """The first run is broken off, as by Ctrl-C, after two tiles."""

        def stop(text):
            told.append(text)
            if text.startswith("2 of"):
                raise Stop

        with pytest.raises(Stop):
            module.make_all(small(), tiles, many, seasons=SEASONS, error=0.02, make=dying, tell=stop)
        result = module.make_all(small(), tiles, many, seasons=SEASONS, error=0.02, make=dying, tell=told.append)
        again = module.make_all(small(), tiles, many, seasons=SEASONS, error=0.02, make=dying, tell=told.append)
        assert told[-1] == "6 tiles are there, 0 to make"
        with pytest.raises(SystemExit, match="another landscape"):
            module.make_all(small(), tiles, many, seasons=SEASONS + 1, error=0.02, make=dying, tell=told.append)
    finally:
        ray.shutdown()
    assert result["tiles"] == again["tiles"] == 6 and result["trees"] == again["trees"]
    tries = sorted(file.name for file in (many / "log").iterdir())
    assert "0_0.1" in tries and "1_-1.1" in tries, tries
    job = json.loads((many / "tiles" / "0_0.json").read_text())["job"]
    for x, z in tiles:
        module.make_tile(small(), job, x, z, SEASONS, 0.02, str(plain))
    assert files(plain) == files(many)
    uris = json.dumps(json.loads((many / "tileset.json").read_text())).count(".far.glb")
    assert uris == sum(f"{x}_{z}.far.glb" in files(many) for x, z in tiles)
