"""`scenic-ref bench` for the gallery's eleven programs, which `released/` holds in the syntax of Scenic 3.

    python benchmarks/batch.py [--against scenic==3.1.1=/path/to/bin/python] [--prune] [--growth] [--json RESULT.json] [...]
"""

from __future__ import annotations

import sys
from pathlib import Path

from scenic_ref.cli import answer

HERE = Path(__file__).parent
EXAMPLES = HERE.parent / "examples" / "gallery"

if __name__ == "__main__":
    try:
        sys.exit(answer(["bench", *map(str, sorted(EXAMPLES.glob("*.scenic"))), "--released", str(HERE / "released"), *sys.argv[1:]]))
    except KeyboardInterrupt:
        sys.exit(130)
