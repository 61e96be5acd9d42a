"""Long work: progress, Ctrl-C, other threads, forests that go on."""

import pickle
import signal
import threading
import time

import numpy as np
import pytest
import treesynth


def test_progress_is_told():
    seen = []
    treesynth.Recipe.preset("figure-06c", 30_000).grow(progress=lambda work, part: seen.append((work, part)))
    assert seen and all(isinstance(work, str) and 0 <= part <= 1 for work, part in seen)
    assert seen[-1][1] == 1


def test_what_progress_raises_stops_the_work():
    def stop(work, part):
        raise RuntimeError("enough")

    recipe = treesynth.Recipe.preset("figure-06c", 3_000_000)
    began = time.monotonic()
    with pytest.raises(RuntimeError, match="enough"):
        recipe.grow(progress=stop)
    assert time.monotonic() - began < 20


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="no timers of signals here")
def test_ctrl_c_stops_the_work_and_forests_keep_what_has_grown():
    def interrupt(number, frame):
        raise KeyboardInterrupt

    forest = treesynth.Forest("stand-generations", most_metamers=5_000_000)
    before = signal.signal(signal.SIGALRM, interrupt)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.5)
        with pytest.raises(KeyboardInterrupt):
            forest.grow(200)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert 0 <= forest.season < 200
    seasons = forest.season
    forest.grow(1)
    assert forest.season == seasons + 1 and forest.metamers > 0


def test_other_threads_go_on():
    counted, is_over = [0], threading.Event()

    def count():
        while not is_over.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    before = counted[0]
    treesynth.Recipe.preset("figure-06c", 200_000).grow()
    after = counted[0]
    is_over.set()
    thread.join()
    assert after - before > 20


def test_forests_are_saved_and_go_on():
    forest = treesynth.Forest("stand-generations", seed=2)
    forest.grow(6)
    again, pickled = treesynth.Forest.from_json(forest.name, forest.to_json()), pickle.loads(pickle.dumps(forest))
    for other in [forest, again, pickled]:
        other.grow(2)
    assert forest.trees == again.trees == pickled.trees
    assert forest.places.shape == (len(forest.trees), 3)
    assert np.isfinite(forest.places).all() and forest.metamers > 100
    with pytest.raises(treesynth.TreesynthError, match="text: missing field"):
        treesynth.Forest.from_json("stand-generations", "{}")


@pytest.mark.parametrize("name", ["stand-hedge", "space-crown"])
def test_stands_of_other_kinds(name):
    forest = treesynth.Forest(name)
    forest.grow(2)
    again = pickle.loads(pickle.dumps(forest))
    forest.grow(1)
    again.grow(1)
    assert forest.trees == again.trees and forest.season == 3


def test_one_forest_from_two_threads():
    forest = treesynth.Forest("stand-generations", seed=1)
    threads = [threading.Thread(target=forest.grow, args=(3,)) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    alone = treesynth.Forest("stand-generations", seed=1)
    alone.grow(6)
    assert forest.season == 6 and forest.trees == alone.trees
