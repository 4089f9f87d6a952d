"""Record the public names of the released classes of roads, which `test_road_names.py` holds against ours.

    python tests/released/record_road_names.py > tests/released/road_names.json     # in an environment with scenic==3.1.1
"""

import json

from scenic.domains.driving import roads

CLASSES = (
    "Network", "ManeuverType", "VehicleType", "NetworkElement", "LinearElement", "Road", "LaneGroup", "Lane", "RoadSection", "LaneSection",
    "Sidewalk", "PedestrianCrossing", "Shoulder", "Intersection", "Signal", "Maneuver",
)  # fmt: skip


def names_of(class_: type) -> list[str]:
    """The names that are no matter of Python's, with the forms that begin with an underscore where there is one without it."""
    found = set(dir(class_)) | {a.name for a in getattr(class_, "__attrs_attrs__", ())}
    if "ManeuverType" in class_.__name__:
        found.add("guessTypeFromLanes")
    return sorted(n for n in found if not n.startswith("_") or n[1:] in found)


if __name__ == "__main__":
    print(json.dumps({name: names_of(getattr(roads, name)) for name in CLASSES}, indent=1))
