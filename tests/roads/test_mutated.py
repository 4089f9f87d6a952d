"""Files in which bytes and elements were changed at random: a map or a message, never an error of ours, and never without end."""

from __future__ import annotations

import random
import re
from collections import Counter

import pytest
from scenic_ref.roads import MapError, opendrive
from scenic_ref.roads.map_generator import generate_map
from scenic_ref.roads.map_summary import faults, summary
from scenic_ref.roads.network_builder import network_of

WORDS = (b"", b"nan", b"inf", b"-1", b"0", b"1e308", b"-1e9", b"1e-12", b"x", b"999999", b"start", b"end", b"junction", b"driving", b"9" * 50)
MAPS = [
    generate_map("crossing", lanes=2, shoulders=True, bike_lanes=True, signals=True, crosswalks=True).encode(), generate_map("highway").encode(),
    generate_map("suburb", rows=2, columns=2, signals=True).encode(),
]  # fmt: skip
COUNT = 300


def changed(data: bytes, chance: random.Random) -> bytes:
    """The file with one to twenty changes: values, elements put in or left out, bytes."""
    found = bytearray(data)
    values = [m.span(1) for m in re.finditer(rb'="([^"]*)"', data)]
    elements = [m.span() for m in re.finditer(rb"<[a-zA-Z]+[^<>]*/>", data)]
    for _ in range(chance.choice((1, 1, 2, 5, 20))):
        kind = chance.random()
        if kind < 0.6:
            a, b = chance.choice(values)
            found[a:b] = chance.choice(WORDS) if chance.random() < 0.7 else data[slice(*chance.choice(values))]
        elif kind < 0.75:
            a, b = chance.choice(elements)
            found[a:b] = b""
        elif kind < 0.85:
            a, _ = chance.choice(elements)
            found[a:a] = data[slice(*chance.choice(elements))]
        elif kind < 0.95:
            found[chance.randrange(len(found))] = chance.randrange(256)
        else:
            a = chance.randrange(len(found))
            del found[a : a + chance.randrange(1, 300)]
    return bytes(found)


def outcome(data: bytes) -> str:
    """What became of a file."""
    try:
        network = network_of(opendrive.parse_opendrive(data))
    except MapError as problem:
        assert problem.message
        return "message"
    summary(network)
    list(faults(network))
    assert network.roadDirection is not None
    return "map with notes" if network.warnings else "map"


@pytest.mark.parametrize("seed", range(3), ids=["crossing", "highway", "suburb"])
@pytest.mark.slow
def test_changed_files_are_a_map_or_a_message(seed: int) -> None:
    chance = random.Random(seed)
    outcomes = Counter(outcome(changed(MAPS[seed], chance)) for _ in range(COUNT // 3))
    assert min(outcomes[kind] for kind in ("map", "map with notes", "message")) >= COUNT / 100, outcomes
