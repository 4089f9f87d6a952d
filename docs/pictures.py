"""Writes conformance/pictured_scenes.json, for the pictures of the page "Differences": it asks the releases for scenes."""

from __future__ import annotations

import json
import sys
from contextlib import ExitStack
from pathlib import Path

from scenic_ref.conformance import load_vectors, results
from scenic_ref.conformance.implementations.environments import implementation
from scenic_ref.conformance.known_differences import causes, shipped_differences
from scenic_ref.conformance.picture_boxes import FILE, visibly_different_scenes

PLACE = Path(__file__).parents[1] / "conformance" / FILE
SECONDS = 15.0


def main() -> None:
    """Ask each release whose results are kept."""
    kept, vectors = results.shipped_results(), {vector.name: vector for vector in load_vectors()}
    with ExitStack() as asked:
        say = lambda line: print(line, file=sys.stderr)  # noqa: E731
        others = {name: asked.enter_context(implementation(name.replace(" ", "=="), SECONDS, say)) for name in kept}
        found = dict(visibly_different_scenes(causes(shipped_differences()), vectors, others, kept))
    lines = [f"  {json.dumps(name)}: {json.dumps(found[name], separators=(',', ':'))}" for name in sorted(found)]
    PLACE.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
    print(f"{len(found)} vectors with scenes in {PLACE}", file=sys.stderr)


if __name__ == "__main__":
    main()
