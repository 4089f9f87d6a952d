"""Road maps: OpenDRIVE files, and the network of roads, lanes and intersections that they describe."""

from __future__ import annotations

from .network import Network
from .network_builder import made_map, read_map
from .opendrive import MapError

__all__ = ["MapError", "Network", "made_map", "read_map"]
