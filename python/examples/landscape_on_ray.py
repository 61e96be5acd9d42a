"""A landscape of any size on a Ray cluster: pip install ray, then

    python landscape_on_ray.py --out landscape --tiles 10                   # on this machine
    python landscape_on_ray.py --out /shared/landscape --tiles 100 --address auto

Each tile is grown alone, by any worker, to the same bits. Its files appear whole or not at all, the one that says that it is done
last, so the program can be stopped and started again at any time: what is on disk is not made anew. Workers that are lost are
replaced. In the end there are

    tileset.json          3D Tiles 1.1: where each model stands, and when it is fine enough
    tiles/X_Z.near.glb    the trees of a tile, and X_Z.far.glb, eight times as coarse
    tiles/X_Z.parquet     a row for each of its trees; `pandas.read_parquet("tiles")` reads all
    tiles/X_Z.json        what the tile is made of, its box, and numbers

`--out` is a folder that all machines of the cluster see.
"""

import argparse
import hashlib
import json
import os
import pathlib
import sys
import time

import numpy as np
import treesynth


def demonstration(seed: int) -> treesynth.Landscape:
    """Hills of some metres; broad trees in the valleys, slender ones above; clearings."""
    step, fields = 4.0, 256
    middle = step * fields / 2
    along = np.arange(fields) * step - middle
    x, z = np.meshgrid(along, along)
    heights = 4.0 * np.sin(x / 37.0) + 3.0 * np.sin(z / 23.0 + x / 61.0)
    planting = np.where(heights > 0.5, 1, 0)
    density = np.clip(0.75 + 0.5 * np.sin(x / 11.0) * np.sin(z / 17.0), 0.0, 1.0)
    return treesynth.Landscape(
        ["stand-decurrent", "stand-excurrent"],
        seed=seed,
        heights=heights,
        planting=planting,
        density=density,
        corner=(-middle, -middle),
        step=step,
    )


def write_whole(path: pathlib.Path, text: str) -> None:
    """Writes a file beside its place and moves it there."""
    draft = path.with_name(f".{path.name}.{os.getpid()}")
    draft.write_text(text, encoding="utf-8")
    os.replace(draft, path)


def make_tile(landscape: treesynth.Landscape, job: str, x: int, z: int, seasons: int, error: float, folder: str) -> dict:
    """Grows one tile and writes its files."""
    started = time.perf_counter()
    place = pathlib.Path(folder) / "tiles"
    name = f"{x}_{z}"
    tile = landscape.grow(x, z, seasons)
    tile.save_table(place / f"{name}.parquet")
    models = tile.save_models(place / f"{name}.near.glb", place / f"{name}.far.glb", error=error)
    done = {
        "job": job,
        "origin": tile.origin,
        "models": models,
        "trees": len(tile.places),
        "metamers": tile.metamers,
    }
    write_whole(place / f"{name}.json", json.dumps(done))
    return done | {"seconds": time.perf_counter() - started}


def finished(folder: pathlib.Path, job: str, x: int, z: int) -> dict | None:
    """What an earlier run has left of a tile, if it is done and of this job."""
    try:
        done = json.loads((folder / "tiles" / f"{x}_{z}.json").read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None
    if done["job"] != job:
        raise SystemExit(f"{folder} holds another landscape; take an empty folder, or remove its tiles")
    return done


def make_all(
    landscape: treesynth.Landscape,
    tiles: list[tuple[int, int]],
    folder: pathlib.Path,
    *,
    seasons: int,
    error: float = 0.02,
    retries: int = 5,
    make=make_tile,
    tell=print,
) -> dict:
    """Makes all tiles that are not there yet on the cluster that Ray is connected to, and `tileset.json`."""
    import ray

    (folder / "tiles").mkdir(parents=True, exist_ok=True)
    text = f"{landscape.to_json()} {seasons} {error} {treesynth.__version__}"
    job = hashlib.sha256(text.encode()).hexdigest()
    done = {tile: there for tile in tiles if (there := finished(folder, job, *tile)) is not None}
    waiting = [tile for tile in tiles if tile not in done]
    tell(f"{len(done)} tiles are there, {len(waiting)} to make")

    # One core a tile: so memory is that of one tile a core, and no core waits.
    worker = ray.remote(num_cpus=1, max_retries=retries, runtime_env={"env_vars": {"RAYON_NUM_THREADS": "1"}})(make)
    shared = ray.put(landscape)
    running, failed, seconds = {}, {}, 0.0
    queue = iter(waiting)
    started = time.perf_counter()
    while True:
        most = 2 * max(1, int(ray.cluster_resources().get("CPU", 1)))
        while len(running) < most and (tile := next(queue, None)) is not None:
            running[worker.remote(shared, job, *tile, seasons, error, str(folder))] = tile
        if not running:
            break
        [task], _ = ray.wait(list(running), num_returns=1)
        tile = running.pop(task)
        try:
            done[tile] = ray.get(task)
            seconds += done[tile]["seconds"]
        except Exception as error:  # of this tile alone; the others go on
            failed[tile] = error
            tell(f"tile {tile}: {error}")
        else:
            trees = sum(tile["trees"] for tile in done.values())
            tell(f"{len(done)} of {len(tiles)} tiles, {trees} trees, {time.perf_counter() - started:.0f} s")
    if failed:
        raise SystemExit(f"{len(failed)} of {len(tiles)} tiles failed: {sorted(failed)}; start again to try them once more")

    entries = [
        (f"tiles/{x}_{z}.near.glb", f"tiles/{x}_{z}.far.glb", own["origin"], *own["models"])
        for (x, z), own in sorted(done.items())
        if own["models"] is not None
    ]
    if entries:
        treesynth.write_tileset(folder / "tileset.json", entries)
    return {
        "tiles": len(done),
        "trees": sum(own["trees"] for own in done.values()),
        "metamers": sum(own["metamers"] for own in done.values()),
        "bytes": sum(file.stat().st_size for file in (folder / "tiles").iterdir()),
        "core_seconds": seconds,
    }


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--out", type=pathlib.Path, required=True)
    arguments.add_argument("--tiles", type=int, default=4, help="tiles along a side")
    arguments.add_argument("--seasons", type=int, default=14)
    arguments.add_argument("--error", type=float, default=0.02, help="of bark from near by, metres")
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--address", help="of a cluster; by default one is started on this machine")
    options = arguments.parse_args()
    if options.tiles < 1:
        arguments.error(f"--tiles is {options.tiles}, but must be at least 1")

    import ray

    ray.init(address=options.address, log_to_driver=False)
    half = options.tiles // 2
    tiles = [(x - half, z - half) for x in range(options.tiles) for z in range(options.tiles)]
    result = make_all(
        demonstration(options.seed),
        tiles,
        options.out.resolve(),
        seasons=options.seasons,
        error=options.error,
        tell=lambda text: print(text, file=sys.stderr),
    )
    print(json.dumps(result))


if __name__ == "__main__":
    main()
