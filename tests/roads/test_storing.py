"""Networks that are kept between processes: what is read is what was made, and nothing else is ever read."""

from __future__ import annotations

import io
import json
import multiprocessing
import os
import pickle
import random
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from threading import Barrier

import numpy as np
import pytest
import scenic_ref
import shapely
from scenic_ref.interpreter.runtime import cache_folders
from scenic_ref.roads import map_cache, network_arrays, opendrive
from scenic_ref.roads.immutable import Fixed
from scenic_ref.roads.map_generator import KINDS, generate_map
from scenic_ref.roads.network import Network
from scenic_ref.roads.network_builder import TOLERANCE, cached_network, network_from, network_of

ALL = {"sidewalks": True, "shoulders": True, "bike_lanes": True, "signals": True, "crosswalks": True}
CASES = [*[(kind, {}) for kind in KINDS], *[(kind, {**ALL, "lanes": 2, "left_hand": True}) for kind in KINDS if kind != "highway"]]
MAP = generate_map("crossing", **ALL).encode()
PROGRAM = "model scenic.domains.driving.model\nego = Car\nCar on road, with requireVisible False\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache directory for maps of any size."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(map_cache, "SMALLEST", 0)
    cached_network.cache_clear()
    return tmp_path / "scenic-ref" / "maps"


def again(source: bytes, tolerance: float = TOLERANCE) -> Network:
    """A network as another process would get it."""
    cached_network.cache_clear()
    return network_from(source, tolerance)


def written(value: object, seen: dict[int, int], waiting: list[Fixed]) -> object:
    """A value in full, bit for bit; objects by their numbers."""
    if isinstance(value, Fixed):
        if id(value) not in seen:
            seen[id(value)] = len(seen)
            waiting.append(value)
        return "object", seen[id(value)]
    if isinstance(value, np.ndarray):
        return value.shape, value.dtype, value.flags.c_contiguous, value.tobytes()
    if isinstance(value, shapely.Geometry):
        return type(value), shapely.to_wkb(value)
    if isinstance(value, Mapping):
        return [(written(key, seen, waiting), written(one, seen, waiting)) for key, one in value.items()]
    if isinstance(value, tuple) and type(value) is tuple:
        return tuple(written(one, seen, waiting) for one in value)
    return type(value), repr(value), value


def in_full(network: Network) -> list[object]:
    """All that a network consists of."""
    seen, waiting, found = {id(network): 0}, [network], []
    while waiting:
        one = waiting.pop()
        given = {
            name: value for name, value in vars(one).items() if name not in network_arrays.APART and not network_arrays.is_calculated(type(one), name)
        }
        found.append((type(one), sorted((name, written(value, seen, waiting)) for name, value in given.items())))
    return found


@pytest.mark.parametrize(("kind", "parameters"), CASES)
def test_what_is_read_is_what_was_made(kind, parameters):
    source = generate_map(kind, **parameters).encode()
    network = network_of(opendrive.parse_opendrive(source), TOLERANCE)
    assert in_full(network_arrays.NetworkReader(network_arrays.NetworkWriter().arrays(network)).network()) == in_full(network)


def test_another_process_reads_no_map(folder, monkeypatch):
    first = network_from(MAP)
    cells = first.roadDirection.cells
    assert len(list(folder.iterdir())) == 2
    monkeypatch.setattr(opendrive, "parse_opendrive", lambda _: pytest.fail("the map is read"))
    monkeypatch.setattr(Network, "direction_cells", lambda _: pytest.fail("the field is made"))
    second = again(MAP)
    assert second is not first and in_full(second) == in_full(first)
    assert [(shapely.to_wkb(p), h) for p, h in second.roadDirection.cells] == [(shapely.to_wkb(p), h) for p, h in cells]
    assert pickle.loads(pickle.dumps(second.lanes[3])).uid == first.lanes[3].uid


def test_scenes_are_the_same(folder):
    Path(folder.parent.parent, "town.xodr").write_bytes(MAP)

    def lines() -> list[str]:
        cached_network.cache_clear()
        scenario = scenic_ref.loads("param map = localPath('town.xodr')\n" + PROGRAM, directory=folder.parent.parent)
        return [scene.to_json() for scene in scenario.sample_many(20, seed=3)]

    first = lines()
    assert len(list(folder.iterdir())) == 2
    assert lines() == first


def test_other_maps_tolerances_and_codes_have_other_files(folder, monkeypatch):
    for count, ask in enumerate([lambda: again(MAP), lambda: again(MAP, 0.06), lambda: again(MAP + b"\n"), lambda: again(MAP)], start=1):
        ask()
        assert len(list(folder.iterdir())) == min(count, 3)
    monkeypatch.setattr(map_cache, "CODE", b"another")
    monkeypatch.setattr(map_cache, "code_there", lambda: b"another")
    again(MAP)
    assert len(list(folder.iterdir())) == 4


def test_code_that_is_changed_while_it_runs_keeps_nothing(folder, monkeypatch):
    monkeypatch.setattr(map_cache, "code_there", lambda: b"newer than what runs")
    assert again(MAP).roadDirection.cells
    assert not folder.exists()


@pytest.mark.parametrize("change", ["other", "more", "gone"])
def test_the_code_is_all_that_the_package_has(tmp_path, monkeypatch, change):
    for folder in ("roads", "semantics/space"):
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / "made.py").write_text("x = 1\n")
    monkeypatch.setattr(cache_folders, "__file__", str(tmp_path / "interpreter" / "runtime" / "cache_folders.py"))
    first = map_cache.code_there()
    (tmp_path / "roads" / ".#made.py").symlink_to("nobody@nowhere")  # as editors lock files
    assert first == map_cache.code_there() != b""
    place = tmp_path / "semantics" / "space" / "made.py"
    if change == "other":
        place.write_text("x = 2\n")
    elif change == "more":
        (tmp_path / "semantics" / "more.py").write_text("y = 1\n")
    else:
        place.unlink()
        place.symlink_to("nowhere.py")
    assert map_cache.code_there() != first and (change != "gone" or map_cache.code_there() == b"")


def test_small_maps_and_unknown_code_are_not_kept(folder, monkeypatch):
    monkeypatch.setattr(map_cache, "SMALLEST", len(MAP) + 1)
    again(MAP)
    monkeypatch.setattr(map_cache, "SMALLEST", 0)
    monkeypatch.setattr(map_cache, "CODE", b"")
    again(MAP)
    assert not folder.exists()


@pytest.mark.sampled(8)
@pytest.mark.parametrize("number", range(60))
def test_what_is_damaged_is_made_again(folder, number):
    first = again(MAP)
    [place] = folder.iterdir()
    whole = place.read_bytes()
    chance = random.Random(number)
    data = bytearray(whole)
    if number % 3:
        data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
    else:
        del data[chance.randrange(len(data)) :]
    place.write_bytes(data)
    assert in_full(again(MAP)) == in_full(first)
    assert place.read_bytes() == whole


class Harmful:
    """What runs something when it is unpickled."""

    def __reduce__(self):
        return pytest.fail, ("it was unpickled",)


def as_file(arrays: object) -> bytes:
    """A file with a digest that is right."""
    buffer = io.BytesIO()
    np.savez(buffer, **arrays) if isinstance(arrays, dict) else np.save(buffer, arrays)
    return map_cache.hashlib.blake2b(buffer.getvalue()).digest() + buffer.getvalue()


def objects(*what: object) -> np.ndarray:
    """Records as a file has them."""
    return np.frombuffer(json.dumps(what).encode(), dtype=np.uint8)


NOTHING = {"points": np.empty((0, 2)), **map_cache.pack_shapes([])}
FORGED = [
    {}, np.zeros(3), {"objects": np.array([Harmful()], dtype=object)}, {"objects": objects()}, {**NOTHING, "objects": objects()},
    {**NOTHING, "objects": objects(["Car", {}])}, {**NOTHING, "objects": objects(["Lane", {}])}, {**NOTHING, "objects": objects(1)},
    {**NOTHING, "objects": objects(["Network", {"roads": [7]}])}, {**NOTHING, "objects": objects(["Network", {"roads": {"run": "x"}}])},
    {**NOTHING, "objects": objects(["Network", {"roads": {"shape": 0}}]), "sizes": np.array([5])},
    {**NOTHING, "objects": objects(["Network", []])}, {**NOTHING, "objects": objects(["Network", {}])},
    {**NOTHING, "objects": np.frombuffer(b"[" * 100_000, dtype=np.uint8)},
]  # fmt: skip


@pytest.mark.parametrize("number", range(len(FORGED)))
def test_what_others_wrote_is_not_run(folder, number):
    first = again(MAP)
    [place] = folder.iterdir()
    place.write_bytes(as_file(FORGED[number]))
    assert in_full(again(MAP)) == in_full(first)


@pytest.mark.parametrize("stop", [OSError(28, "No space left on device"), KeyboardInterrupt()], ids=["a full disk", "Ctrl-C"])
def test_nothing_half_written_is_left(folder, monkeypatch, stop):
    def fail(*_: object) -> None:
        raise stop

    monkeypatch.setattr(map_cache.os, "replace", fail)
    try:
        again(MAP)
    except KeyboardInterrupt:
        assert isinstance(stop, KeyboardInterrupt)
    assert list(folder.iterdir()) == []


def test_where_nothing_can_be_written_nothing_is_kept(folder, monkeypatch):
    Path(folder.parent.parent, "scenic-ref").write_text("")
    assert in_full(again(MAP)) == in_full(network_of(opendrive.parse_opendrive(MAP), TOLERANCE))


def test_what_was_not_used_for_longest_goes_first(folder, monkeypatch):
    monkeypatch.setattr(map_cache, "MOST", 3)
    sources = [MAP + b"\n" * k for k in range(4)]
    places = [map_cache.map_cache_path("network", source, TOLERANCE) for source in sources]
    for k in range(3):
        again(sources[k])
        os.utime(places[k], (k, k))
    again(sources[0])  # used just now
    again(sources[3])
    assert [place.exists() for place in places] == [True, False, True, True]
    monkeypatch.setattr(map_cache, "MOST_BYTES", 1)
    again(MAP + b" ")
    assert list(folder.iterdir()) == []


def test_files_of_others_stay_and_hinder_nothing(folder, monkeypatch):
    monkeypatch.setattr(map_cache, "MOST", 3)
    folder.mkdir(parents=True)
    (folder / "thesis.tex").write_text("")
    os.utime(folder / "thesis.tex", (0, 0))
    (folder / "away.map").symlink_to("nowhere")
    for k in range(5):
        again(MAP + b"\n" * k)
    assert (folder / "thesis.tex").exists() and len(list(folder.iterdir())) == 4


def test_a_clock_that_was_wrong_hinders_nothing(folder, monkeypatch):
    monkeypatch.setattr(map_cache, "MOST", 2)
    for k in range(2):
        again(MAP + b"\n" * k)
    for place in folder.iterdir():
        os.utime(place, (4e9, 4e9))
    again(MAP + b" ")
    again(MAP + b"  ")
    assert any(place.stat().st_mtime < 3.9e9 for place in folder.iterdir())


def written_by_another(begin: Barrier, home: str) -> str:
    """What another process gets, when all begin."""
    os.environ["XDG_CACHE_HOME"] = home
    map_cache.SMALLEST = 0
    begin.wait(60)
    network = network_from(MAP)
    return repr((network, len(network.roadDirection.cells)))


@pytest.mark.slow
def test_processes_may_write_at_the_same_time(folder):
    spawning = multiprocessing.get_context("spawn")
    with spawning.Manager() as manager, ProcessPoolExecutor(4, mp_context=spawning) as pool:
        begin = manager.Barrier(4)
        told = [one.result() for one in [pool.submit(written_by_another, begin, str(folder.parent.parent)) for _ in range(4)]]
    assert len(set(told)) == 1 and sorted(place.suffix for place in folder.iterdir()) == [".map", ".map"]
    assert in_full(again(MAP)) == in_full(network_of(opendrive.parse_opendrive(MAP), TOLERANCE))
