"""As a script, in an environment with `ad_map_access`: what its reader says of the lanes of maps, as JSON.

python contacts.py FILE...    {FILE: {lane: {"type": ..., "reversed": ..., "contacts": [[where, lane], ...]}}}
"""

import json
import sys

import ad_map_access as ad  # pyright: ignore[reportMissingImports]  # in its own environment

found = {}
for path in sys.argv[1:]:
    ad.map.access.cleanup()
    with open(path, encoding="utf-8") as file:
        text = file.read()
    ad.map.access.initFromOpenDriveContent(text, 0.2, ad.map.intersection.IntersectionType.TrafficLight, ad.map.landmark.TrafficLightType.UNKNOWN)
    found[path] = {}
    for id in ad.map.lane.getLanes():
        lane = ad.map.lane.getLane(id)
        contacts = [[str(contact.location), str(contact.to_lane)] for contact in lane.contact_lanes]
        found[path][str(id)] = {"type": str(lane.type), "reversed": str(lane.direction) == "NEGATIVE", "contacts": contacts}
print(json.dumps(found))
