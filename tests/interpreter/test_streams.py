"""Counter-based random numbers: NumPy's Philox bit for bit, and a pure function of seed, scene, attempt and address."""

from __future__ import annotations

import math
from itertools import islice

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenic_ref.interpreter.runtime.random_streams import Stream, fold, mix, philox_words, site_code

words = st.integers(0, 2**64 - 1)
ALPHA = 1e-9


def numpy_blocks(key: tuple[int, int], counter: tuple[int, int, int, int], count: int) -> list[list[int]]:
    """NumPy's blocks from `counter` on: it adds 1 to the counter, lowest word first, before each."""
    before = (sum(word << (64 * place) for place, word in enumerate(counter)) - 1) % 2**256
    parts = [before >> (64 * place) & (2**64 - 1) for place in range(4)]
    generator = np.random.Philox(key=np.array(key, np.uint64), counter=np.array(parts, np.uint64))
    return generator.random_raw(4 * count).reshape(count, 4).tolist()


@given(st.tuples(words, words), st.tuples(words, words, words, words))
def test_philox_is_numpys_bit_for_bit(key: tuple[int, int], counter: tuple[int, int, int, int]) -> None:
    assert [list(philox_words(key, counter))] == numpy_blocks(key, counter, 1)


def test_philox_gives_the_published_answer_to_zeros() -> None:
    """A known-answer test of Random123, the authors' own library."""
    assert philox_words((0, 0), (0, 0, 0, 0)) == (0x16554D9ECA36314C, 0xDB20FE9D672D0FDC, 0xD7E772CEE186176B, 0x7E68B68AEC7BA23B)


def test_blocks_of_consecutive_scenes_are_consecutive_for_numpy() -> None:
    address = (3, 1, 4)
    blocks = numpy_blocks((5, site_code(address)), (100, 2, 0, 0), 50)
    for number, block in enumerate(blocks):
        uniform = Stream(5, 100 + number, 2).at(address)
        assert [uniform() for _ in range(4)] == [(word >> 11) * 2.0**-53 for word in block]


def test_a_site_goes_on_with_the_next_block() -> None:
    address = (7,)
    uniform = Stream(5, 1, 2).at(address)
    numbers = [uniform() for _ in range(12)]
    expected = [word for block in range(3) for word in numpy_blocks((5, site_code(address)), (1, 2, block, 0), 1)[0]]
    assert numbers == [(word >> 11) * 2.0**-53 for word in expected]


def test_a_number_is_that_of_numpys_generator() -> None:
    generator = np.random.Philox(key=np.array([5, site_code((1,))], np.uint64), counter=np.array([8, 3, 0, 0], np.uint64))
    uniform = Stream(5, 9, 3).at((1,))
    assert [uniform() for _ in range(4)] == np.random.Generator(generator).random(4).tolist()


@given(st.integers(), words, words, st.lists(st.integers(), max_size=4).map(tuple))
def test_numbers_depend_on_nothing_else(seed: int, scene: int, attempt: int, address: tuple[int, ...]) -> None:
    first, second = Stream(seed, scene, attempt).at(address), Stream(seed, scene, attempt).at(address)
    interleaved = [(first(), second()) for _ in range(6)]
    assert all(a == b and 0 <= a < 1 for a, b in interleaved)


@pytest.mark.parametrize(
    "other",
    [
        (Stream(1, 0, 0), (0,)),
        (Stream(0, 1, 0), (0,)),
        (Stream(0, 0, 1), (0,)),
        (Stream(0, 0, 0), (1,)),
        (Stream(0, 0, 0), (0, 0)),
        (Stream(0, 0, 0), ()),
    ],
)
def test_each_coordinate_matters(other: tuple[Stream, tuple[int, ...]]) -> None:
    stream, address = other
    assert stream.at(address)() != Stream(0, 0, 0).at((0,))()


def test_seeds_of_any_size_and_sign_differ() -> None:
    seeds = [0, 1, -1, 2**64 - 1, 2**64, 2**64 + 1, -(2**64), 2**128, 2**128 + 1, 10**100]
    assert len({fold(seed) for seed in seeds}) == len(seeds)
    assert [fold(seed) for seed in seeds[:2]] == [0, 1]


def test_mix_is_the_output_function_of_splitmix64() -> None:
    """The first numbers of SplitMix64 from the state 1234567, as published with it."""
    assert [mix((1234567 + k * 0x9E3779B97F4A7C15) % 2**64) for k in (1, 2)] == [6457827717110365317, 3203168211198807973]


def test_addresses_of_a_whole_program_have_codes_of_their_own() -> None:
    addresses = [(a, b, c) for a in range(60) for b in range(60) for c in range(-5, 5)] + [(a,) for a in range(1000)]
    assert len({site_code(address) for address in addresses}) == len(addresses)


@pytest.mark.parametrize("along", ["scenes", "attempts", "sites", "draws"])
def test_numbers_are_uniform_along_every_coordinate(along: str) -> None:
    """Dvoretzky-Kiefer-Wolfowitz bound; a fresh seed raises a false alarm with probability 1e-9. A rival, u², is rejected."""
    count = 20_000
    if along == "draws":
        uniform = Stream(3, 0, 0).at((1,))
        numbers = [uniform() for _ in range(count)]
    else:
        at = {
            "scenes": lambda k: Stream(3, k, 0).at((1,)),
            "attempts": lambda k: Stream(3, 0, k).at((1,)),
            "sites": lambda k: Stream(3, 0, 0).at((1, k)),
        }[along]
        numbers = [at(k)() for k in range(count)]
    bound = math.sqrt(math.log(2 / ALPHA) / (2 * count))
    steps = np.arange(count + 1) / count
    for power, uniform_too in ((1, True), (2, False)):
        ordered = np.sort(np.power(numbers, power))
        distance = float(max(np.max(steps[1:] - ordered), np.max(ordered - steps[:-1])))
        assert (distance < bound) is uniform_too
    assert len(set(islice(numbers, count))) == count
