"""From an OpenDRIVE file to the network."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache, partial
from pathlib import Path

import shapely

from ..interpreter.regular_file import name_and_folder, read_regular_file
from ..interpreter.walls import timed
from . import opendrive
from .assembly import Assembly
from .elements import BikeLane, Lane, PedestrianCrossing, Road, Shoulder, Sidewalk
from .fixed import complete
from .furniture import crossings, signals
from .intersections import Intersection
from .junctions import intersection, link_lanes, link_roads, note_dangling
from .lanes import make_road, make_sections
from .making import made
from .network import Network
from .notes import Notes
from .opendrive import OpenDrive
from .records import keep_network, load_network
from .shapes import section_shapes
from .signals import Signal
from .xml import LARGEST, MapError

TOLERANCE = 0.05
"""Metres by which a point may miss an element."""
OVERLAP = 0.5
"""Square metres that two roads outside intersections may share."""


def read_map(path: Path | str, tolerance: float = TOLERANCE) -> Network:
    """The network of an OpenDRIVE file, `tolerance` in metres. Raises `MapError` for what is none or is broken."""
    try:
        data = read_regular_file(path, LARGEST)
    except FileNotFoundError:
        raise MapError(f"there is no map {name_and_folder(path)}") from None
    except OSError as error:
        raise MapError(f"the map {path} cannot be read: {error.strerror or error}") from None
    try:
        return network_within(data, tolerance)
    except MapError as problem:
        raise MapError(f"{path} is no usable OpenDRIVE map: {problem.message}") from None


@timed("reading a map")
def network_within(data: bytes, tolerance: float) -> Network:
    """As `network_from`, in the time that a program has for its maps."""
    return network_from(data, tolerance)


def made_map(kind: str, **parameters: bool | float) -> Network:
    """The network of a map that `making.made` makes. Raises `ValueError` as it does."""
    return network_from(made(kind, **parameters).encode())


def network_from(data: bytes, tolerance: float = TOLERANCE) -> Network:
    """The network of what is in an OpenDRIVE file; the same one for the same file, since it is immutable. Raises `MapError`."""
    return kept(data, float(tolerance))


@lru_cache(maxsize=4)
def kept(data: bytes, tolerance: float) -> Network:
    """The network, once it is made; that of a large map also for other processes."""
    found = load_network(data, tolerance)
    if found is not None:
        return complete(found, source=data, again=partial(network_from, tolerance=tolerance))
    made = network_of(opendrive.read(data), tolerance)
    keep_network(made)
    return made


def network_of(file: OpenDrive, tolerance: float = TOLERANCE) -> Network:
    """The network that a file describes. Raises `MapError` if there is no lane to drive on."""
    net = Assembly(file)
    for road in file.roads.values():
        net.shapes[road.id] = list(section_shapes(road, net.notes))
        make_sections(net, road)
    for road in file.roads.values():
        make_road(net, road)
    note_dangling(net)
    link_lanes(net)
    intersections = [found for one in file.junctions.values() if (found := intersection(net, one)) is not None]
    link_roads(net, intersections)
    lights = signals(net, intersections)
    crossings(net, intersections)
    for lane in net.of(Lane):
        complete(lane, maneuvers=tuple(net.maneuvers.get(lane, ())))
    return finished(net, intersections, lights, tolerance)


def finished(net: Assembly, intersections: Sequence[Intersection], signals: Sequence[Signal], tolerance: float) -> Network:
    """The network, which every element then knows."""
    records = net.file.roads
    ordinary = [road for id, road in net.roads.items() if records[id].junction is None]
    connecting = [road for id, road in net.roads.items() if records[id].junction is not None]
    roads = (*ordinary, *connecting)
    lanes = [lane for road in roads for lane in road.lanes]
    if not lanes:
        raise MapError("; ".join(["it has no lanes on which to drive", *net.notes.lines()]))
    note_overlaps(ordinary, net.notes)
    made = Network.of(
        source=net.file.data, again=partial(network_from, tolerance=tolerance), by_uid=net.elements,
        roads=tuple(ordinary), connectingRoads=tuple(connecting), allRoads=roads, intersections=tuple(intersections),
        laneGroups=tuple(group for road in roads for group in road.laneGroups), lanes=tuple(lanes), crossings=net.of(PedestrianCrossing),
        sidewalks=net.of(Sidewalk), shoulders=net.of(Shoulder), bikeLanes=net.of(BikeLane), signals=tuple(signals),
        roadSections=tuple(section for road in ordinary for section in road.sections),
        laneSections=tuple(section for lane in lanes for section in lane.sections),
        driveOnLeft=sum(record.left_hand for record in records.values()) * 2 > len(records), tolerance=tolerance,
        warnings=tuple(net.notes.lines()),
    )  # fmt: skip
    for element in net.elements.values():
        complete(element, network=made)
    return made


def note_overlaps(roads: Sequence[Road], notes: Notes) -> None:
    """Note roads outside intersections that share an area, as bridges do in the plane."""
    if not roads:
        return
    polygons = [road.polygon for road in roads]
    for i, j in zip(*shapely.STRtree(polygons).query(polygons, predicate="intersects"), strict=True):
        if i < j and (shared := shapely.intersection(polygons[i], polygons[j]).area) > OVERLAP:
            notes.add("roads that overlap", f"{roads[i].uid} and {roads[j].uid} in {shared:.1f} m²")
