"""How any maps are read here, in the release and by `ad_map_access`: `python -m scenic_ref.tests.roads.beside_others FILE.xodr...`, with figures.

Differences that `EXPLAINED` explains are only counted.
"""

from __future__ import annotations

import random
import sys
from collections import defaultdict
from pathlib import Path
from tempfile import TemporaryDirectory

from scenic_ref.roads import read_map
from scenic_ref.roads.map_summary import faults

from .comparing import differences, of_ours, points_of
from .test_contacts import compared
from .test_network_in_release import EXPLAINED, REF_POINTS, of_release, significant

SHOWN = 5


def beside_release(path: Path) -> int:
    """Tell how the release reads a map; how many differences nothing explains."""
    network = read_map(path)
    lanes, anywhere = points_of(network, random.Random(0))
    ours = of_ours(network, lanes, anywhere)
    with TemporaryDirectory() as folder:
        asked: dict[str, object] = {"path": str(path), "lanes": lanes, "anywhere": anywhere, "ref_points": REF_POINTS}
        [theirs] = of_release({"map": asked}, Path(folder)).values()
    largest: dict[str, float] = defaultdict(float)
    explained, others = 0, []
    for one in differences(ours, theirs):
        if one.amount is not None:
            largest[f"{one.kind} {one.what}"] = max(largest[f"{one.kind} {one.what}"], one.amount)
        if significant(one):
            known = any(reason.of(one, ours) for reason in EXPLAINED)
            explained += known
            others += [] if known else [one]
    told = ("lane centerline", "point roadDirection", "network drivable area")
    print(f"{path}: {len(network.lanes)} lanes; {', '.join(f'{what} {largest[what]:.4f}' for what in told)}")
    print(f"  {explained} differences explained, {len(others)} others, {sum(1 for _ in faults(network))} faults", *others[:SHOWN], sep="\n  ")
    return len(others)


def main(paths: list[Path]) -> int:
    """Both comparisons of each map; the exit code."""
    wrong = sum(map(beside_release, paths))
    for path, ours, theirs in compared(paths):
        apart = {lane for lane in {*ours, *theirs} if ours.get(lane) != theirs.get(lane)}
        print(f"{path}: contacts of {len(theirs)} lanes, {len(apart)} of them otherwise", *sorted(apart)[:SHOWN])
        wrong += len(apart)
    return int(wrong > 0)


if __name__ == "__main__":
    raise SystemExit(main([Path(argument) for argument in sys.argv[1:]]))
