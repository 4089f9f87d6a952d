"""Is every `scenic-3` text of the vectors Scenic 3? The released parser is asked, by a Python in whose environment the release is installed.

`python released.py PYTHON` exits with 1 and says which texts that release cannot parse; `make nightly` runs it. Vectors of syntax
errors are left out.
"""

from __future__ import annotations

import json
import subprocess
import sys

from scenic_ref.conformance import load_vectors
from scenic_ref.conformance.refusals import Error

ASK = """
import json, sys
from scenic.syntax.parser import parse_string
found = {}
for name, text in json.load(sys.stdin).items():
    try:
        parse_string(text, "exec")
    except Exception as error:
        found[name] = f"{type(error).__name__}: {error}"
json.dump(found, sys.stdout)
"""


def texts() -> dict[str, str]:
    """The texts that must be programs of Scenic 3, by the names of their vectors."""
    vectors = [v for v in load_vectors() if not (isinstance(v.matcher, Error) and "parse" in v.matcher.phases)]
    return {v.name: v.texts["scenic-3"] for v in vectors if "scenic-3" in v.texts}


def refused(python: str) -> dict[str, str]:
    """Those that the release in that environment cannot parse, and its words."""
    answer = subprocess.run([python, "-c", ASK], input=json.dumps(texts()), capture_output=True, text=True, check=True)
    return json.loads(answer.stdout)


if __name__ == "__main__":
    found = refused(sys.argv[1])
    for name, words in found.items():
        print(f"{name}: {words}")
    print(f"{len(texts()) - len(found)} of {len(texts())} texts are Scenic 3")
    sys.exit(1 if found else 0)
