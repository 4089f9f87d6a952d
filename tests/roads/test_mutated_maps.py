"""Broken and hostile maps: each is a map, or an error that says so; none ends the process, waits for ever or goes through more than its limits.

`python tests/roads/test_mutated_maps.py PARSER FIRST LAST` reads mutated inputs FIRST to LAST - 1 in a process that may die.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import random
import struct
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import scenic_ref
from scenic_ref.roads import map_cache, opendrive
from scenic_ref.roads.geodata import read_site, site_from
from scenic_ref.roads.map_generator import generate_map
from scenic_ref.roads.network_builder import network_of
from scenic_ref.roads.xml_elements import MapError
from scenic_ref.semantics.store import errors

MOST = 2000
"""Mutated inputs of each parser that CI reads."""
SQUARE = [[0, 0], [9, 0], [9, 9], [0, 9], [0, 0]]
FEATURES = [
    {"type": "Feature", "properties": {"name": "a", "heading": 30}, "geometry": {"type": "Polygon", "coordinates": [SQUARE, [[1, 1], [2, 1], [2, 2], [1, 1]]]}},
    {"type": "Feature", "id": 7, "properties": {"bearing": 90.5}, "geometry": {"type": "MultiLineString", "coordinates": [[[0, 0], [5, 5]], [[1, 0], [2, 7]]]}},
    {"type": "Feature", "properties": None, "geometry": {"type": "GeometryCollection", "geometries": [{"type": "Point", "coordinates": [3, 4]}]}},
]
WKT = """# a map
SRID=25832; a: POLYGON((0 0, 9 0, 9 9, 0 9, 0 0), (1 1, 2 1, 2 2, 1 1))
b: SRID=25832; GEOMETRYCOLLECTION(LINESTRING(1 2, 3 4), MULTILINESTRING((0 0, 5 5), (1 0, 2 7)))
SRID=25832; MULTIPOLYGON(((0 0, 1 0, 1 1, 0 0)), ((5 5, 6 5, 6 6, 5 5)))
"""
WORDS = (b"", b"0", b"-1", b"1e308", b"nan", b"inf", b"9" * 400, b"9" * 5000, b"(", b")" * 40, b"(" * 4000, b"[" * 4000, b"{", b"}", b'"', b":", b";", b",", b"<", b">", b"</", b"\x00", b"\xff", b"\xff\xff\xff\x7f",
         b"null", b"true", b"\xe2\x80\xae", b"SRID=", b"EMPTY", b"GEOMETRYCOLLECTION(" * 200, b" " * 3000, b"<!DOCTYPE x>", b"\n" * 50)  # fmt: skip


@cache
def shapefiles() -> Mapping[str, bytes]:
    """The parts of a shapefile."""
    import shapefile

    parts = {"shp": io.BytesIO(), "shx": io.BytesIO(), "dbf": io.BytesIO()}
    writer = shapefile.Writer(**parts)
    writer.field("name", "C")
    writer.field("heading", "N", decimal=2)
    for number in range(4):
        writer.poly([[[x + number, y] for x, y in SQUARE]])
        writer.record(f"n{number}", number)
    writer.close()
    return {name: part.getvalue() for name, part in parts.items()}


def with_shapefile(data: bytes) -> None:
    """Read a shapefile of which one part is the given one: which, its first byte says."""
    parts = dict(shapefiles())
    name = ("shp", "shx", "dbf")[data[0] % 3]
    parts[name] = data[1:]
    with tempfile.TemporaryDirectory() as folder:
        for ending, content in parts.items():
            (Path(folder) / f"m.{ending}").write_bytes(content)
        read_site(Path(folder) / "m.shp")


def with_cache(data: bytes) -> None:
    """Use a file that keeps shapes, as if somebody had forged it."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "x.map"
        place.write_bytes(hashlib.blake2b(data).digest() + data)
        arrays = map_cache.arrays_in(place)
        try:
            map_cache.unpack_shapes(arrays or {})
        except map_cache.FAULTS:
            raise MapError("forged") from None


def kept() -> bytes:
    """What a file has that keeps shapes."""
    import shapely

    shapes = [shapely.box(0, 0, 1, 1), shapely.MultiPolygon([shapely.box(0, 0, 1, 1), shapely.box(5, 5, 6, 6)]), shapely.Point(1, 2), shapely.LineString([(0, 0), (1, 1)])]
    buffer = io.BytesIO()
    np.savez(buffer, **map_cache.pack_shapes(shapes))  # type: ignore[arg-type]
    return buffer.getvalue()


PARSERS: Mapping[str, tuple[Callable[[], bytes], Callable[[bytes], object]]] = {
    "opendrive": (lambda: generate_map("t").encode(), lambda data: network_of(opendrive.parse_opendrive(data))),
    "geojson": (lambda: json.dumps({"type": "FeatureCollection", "crs": None, "features": FEATURES}).encode(), lambda data: site_from(data, False, None)),
    "wkt": (lambda: WKT.encode(), lambda data: site_from(data, True, "metres")),
    "shapefile": (lambda: b"\x00" + shapefiles()["shp"], with_shapefile),
    "cache": (kept, with_cache),
}  # fmt: skip


def mutated(source: random.Random, data: bytes) -> bytes:
    """The bytes of a file, some of them deleted, doubled, changed, or words put in."""
    found = bytearray(data)
    for _ in range(source.choice((1, 1, 2, 4, 16))):
        place = source.randrange(len(found) + 1)
        match source.randrange(6):
            case 0:
                del found[place : place + source.choice((1, 4, 50))]
            case 1:
                found[place:place] = found[place : place + source.randrange(1, 200)]
            case 2:
                found[place:place] = source.choice(WORDS)
            case 3 if place < len(found):
                found[place] ^= 1 << source.randrange(8)
            case 4:
                found[place : place + 4] = struct.pack("<i", source.choice((0, -1, 1, 2**31 - 1, 7, 6, 1000)))
            case _:
                found[place : place + source.choice((1, 3, 8))] = source.choice(WORDS)
    return bytes(found)


def ends_of(parser: str, numbers: range) -> tuple[int, int]:
    """How many of the mutated inputs are maps, and how many are not. Raises for what is neither, and says which."""
    make, read = PARSERS[parser]
    data, maps, others = make(), 0, 0
    for number in numbers:
        source = random.Random(f"{parser}:{number}")
        one = mutated(source, bytes([number % 3]) + shapefiles()[("shp", "shx", "dbf")[number % 3]] if parser == "shapefile" else data)
        try:
            read(one)
            maps += 1
        except errors.UsageError:
            others += 1
        except BaseException as problem:
            raise AssertionError(f"{parser} {number}: {type(problem).__name__}: {problem}"[:500]) from problem
    return maps, others


def apart(parser: str, first: int, last: int) -> tuple[int, int]:
    """`ends_of` in a process that may die."""
    command = [sys.executable, "-X", "faulthandler", str(Path(__file__)), parser, str(first), str(last)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2500:]
    maps, others = map(int, done.stdout.split())
    return maps, others


NEEDING = [pytest.param(parser, marks=[pytest.mark.extra("geo")] * (parser == "shapefile")) for parser in PARSERS]


@pytest.mark.parametrize("parser", NEEDING)
def test_mutated_maps_are_maps_or_errors(parser):
    assert sum(apart(parser, 0, 100)) == 100


@pytest.mark.slow
@pytest.mark.parametrize("parser", NEEDING)
def test_many_mutated_maps_are_maps_or_errors(parser):
    count = int(os.environ.get("SCENIC_REF_HOSTILE", MOST))
    maps, others = apart(parser, 100, 100 + count)
    assert maps + others == count
    assert others > count // 20


BROKEN = {
    "spaces": ("m.wkt", " " * 6000 + "x"), "a name of spaces": ("m.wkt", "a" + " " * 20_000 + "("), "deep": ("m.wkt", "GEOMETRYCOLLECTION(" * 100_000), "deeper": ("m.wkt", "GEOMETRYCOLLECTION(" * 5000 + "POINT(1 1)" + ")" * 5000),
    "digits of a code": ("m.wkt", f"SRID={'9' * 5000}; POINT(1 1)"), "digits": ("m.geojson", '{"type": "Point", "coordinates": [' + "9" * 5000 + ", 1]}"),
    "digits of a property": ("m.geojson", json.dumps({"type": "Feature", "properties": {"heading": 10**299}, "geometry": {"type": "Polygon", "coordinates": [SQUARE]}}).replace("1" + "0" * 299, "1" * 5000)),
    "a huge heading": ("m.geojson", json.dumps({"type": "Feature", "properties": {"heading": 10**400}, "geometry": {"type": "Polygon", "coordinates": [SQUARE]}})),
    "collections": ("m.geojson", '{"type": "GeometryCollection", "geometries": [' * 300 + "]}" * 300), "lists": ("m.geojson", '{"type": "Point", "coordinates": ' + "[" * 5000 + "]" * 5000 + "}"),
    "objects": ("m.geojson", '{"a":' * 5000 + "1" + "}" * 5000),
}  # fmt: skip


@pytest.mark.parametrize("what", BROKEN)
def test_a_map_without_bounds_is_an_error_soon(what, tmp_path, effort):
    name, text = BROKEN[what]
    (tmp_path / name).write_text(text)

    def ends() -> None:
        with pytest.raises(MapError):
            read_site(tmp_path / name, "metres")

    assert effort(ends) < 20


@pytest.mark.parametrize("name", ["m.geojson", "m.wkt", "m.shp", "m.xodr", "other.scenic"])
def test_a_pipe_is_no_file_that_a_program_names(name, tmp_path):
    os.mkfifo(tmp_path / name)
    uses = {"xodr": f"param map = '{tmp_path / name}'\nmodel scenic.domains.driving.model\nego = Object", "scenic": "import other\nego = Object"}
    text = uses.get(name.partition(".")[2], f"param map = '{tmp_path / name}'\nmodel site_map\nego = Object")
    with pytest.raises(errors.ScenicError, match="no module other" if name == "other.scenic" else "no ordinary file"):
        scenic_ref.loads(text, directory=tmp_path).sample()


def test_a_file_that_is_too_large_is_not_read(tmp_path):
    with (tmp_path / "m.wkt").open("wb") as file:
        file.truncate(65 << 20)
    with pytest.raises(MapError, match="too large"):
        read_site(tmp_path / "m.wkt")


def test_a_forged_file_of_shapes_is_not_believed():
    inner = struct.pack("<bI", 1, 1) + struct.pack("<dd", 1, 2)
    for _ in range(100_000):
        inner = struct.pack("<bII", 1, 6, 1) + inner if len(inner) < 2_000_000 else inner
    arrays = {"shapes": np.frombuffer(inner, dtype=np.uint8), "sizes": np.array([len(inner)])}
    with pytest.raises(ValueError, match="own kind"):
        map_cache.unpack_shapes(arrays)


if __name__ == "__main__":
    print(*ends_of(sys.argv[1], range(int(sys.argv[2]), int(sys.argv[3]))))
