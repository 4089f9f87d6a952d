"""The dynamic listings of the paper stand in their programs as they are printed, and these run without a crash, in every simulator."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import pytest
from scenic_ref.conformance.listings import LineOrigin, complete_listings
from scenic_ref.roads.map_generator import generate_map

from .listed import FOLDER, LISTINGS, PROGRAMS, SIMULATORS, boxes, simulated

BY_FILE = {program.file: program for program in PROGRAMS}
LONG = {"random_selection.scenic", "stop_after_time_in_intersection.scenic", "drive_with_random_stops.scenic", "car_c_enters_last.scenic"}
FILES = [pytest.param(file, marks=pytest.mark.slow) if file in LONG else file for file in BY_FILE]
PAPER = FOLDER.parents[2] / "tests" / "interpreter" / "listings.txt"
FIRST, LAST = "Agents, Actions, and Behaviors", "Random Selection of Scenarios"


def test_the_listings_are_those_of_the_paper() -> None:
    chunks = [chunk.partition("\n") for chunk in PAPER.read_text("utf-8").split("=== ")[1:]]
    found = [(head.split(" | ")[1], body.rstrip("\n")) for head, _, body in chunks]
    sections = [section for section, _ in found]
    end = len(sections) - sections[::-1].index(LAST)
    assert [(listing.section, listing.printed) for listing in LISTINGS.values()] == found[sections.index(FIRST) : end]
    assert {name for program in PROGRAMS for name in program.listings} == set(LISTINGS)


def test_every_program_is_listed() -> None:
    assert {path.name for path in FOLDER.glob("*.scenic")} == set(BY_FILE) and len(BY_FILE) == len(PROGRAMS)


@pytest.mark.parametrize("file", BY_FILE)
def test_the_listings_stand_in_the_program_as_they_are_printed(file: str) -> None:
    text = (FOLDER / file).read_text("utf-8")
    listings = [LISTINGS[name] for name in BY_FILE[file].listings]
    lines = complete_listings(text, listings)
    assert [line.text for line in lines] == text.splitlines()
    assert sum(line.origin is not LineOrigin.ADDED for line in lines) == sum(len(listing.lines) for listing in listings)
    assert all(("..." in line.printed) == (line.origin is LineOrigin.FILLED) for line in lines)
    for number, line in enumerate(lines):  # any change of a line that is not added is noticed
        if line.origin is LineOrigin.PRINTED:
            changed = [other.text for other in lines]
            changed[number] = changed[number].replace(line.text.strip(), f"{line.text.strip()}  # more")
            with pytest.raises(ValueError, match="as it is printed"):
                complete_listings("\n".join(changed), listings)


def test_a_listing_may_not_be_indented_here_and_there() -> None:
    listing = replace(LISTINGS["wait until close"], printed="if a:\n    b\nc")
    assert len(complete_listings("  if a:\n      b\n  # between\n  c\n", [listing])) == 4
    with pytest.raises(ValueError, match="wait until close"):
        complete_listings("  if a:\n      b\nc\n", [listing])


def test_the_long_street_is_one_of_the_writer() -> None:
    street = generate_map("crossing", lanes=2, leg=400.0, shoulders=True, shoulder_width=2.5, signals=True, crosswalks=True)
    assert (FOLDER / "avenue.xodr").read_text("utf-8") == street


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
@pytest.mark.parametrize("simulator", SIMULATORS)
@pytest.mark.parametrize("file", FILES)
def test_the_program_runs_and_nothing_crashes(file: str, simulator: str, seed: int) -> None:
    run = simulated(file, simulator, BY_FILE[file].seed + seed)[0]
    assert any(moment.actions for moment in run.moments) or file == "parked_cars.scenic"
    for moment in run.moments:
        assert not [event for event in moment.events if "collision" in event]
        for one, other in combinations(boxes(run, moment), 2):
            assert not one.intersects(other)
