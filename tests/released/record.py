"""What a release says of the programs: `python tests/released/record.py scenic-3 PYTHON` asks a Python with that release installed.

It writes the record that `test_released.py` reads, or with `--check` exits with 1 and names the programs of which the release now says otherwise.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

from test_released import CASES, HERE, text_in

ASK = '''
import contextlib, io, json, os, random, signal, sys, tempfile, warnings
warnings.simplefilter("ignore")
os.chdir(tempfile.mkdtemp())
import numpy, scenic
import scenic.syntax.veneer as veneer
from scenic.core.distributions import RejectionException
from scenic.core.simulators import DummySimulator
from scenic.core.vectors import Vector

THREE = not hasattr(scenic.syntax.translator, "constructorStatements")

def plain(x):
    if isinstance(x, numpy.generic): return plain(x.item())
    if isinstance(x, (bool, int, float, str)) or x is None: return x
    if isinstance(x, Vector): return {"vector": [float(x.x), float(x.y)]}
    if isinstance(x, (list, tuple)): return [plain(y) for y in x]
    if isinstance(x, dict): return {str(k): plain(v) for k, v in x.items()}
    if hasattr(x, "position") and hasattr(x, "heading"): return {"oriented": plain(x.position)["vector"] + [float(x.heading)]}
    if hasattr(x, "position"): return {"point": plain(x.position)["vector"]}
    return {"type": type(x).__name__}

def once(program, seed):
    random.seed(seed); numpy.random.seed(seed)
    try:
        scenario = scenic.scenarioFromString(program["text"], **({"mode2D": True} if THREE else {}))
        scene, _ = scenario.generate(maxIterations=300)
        found = {}
        if program["steps"] is not None:
            for _ in range(30):
                simulation = DummySimulator().simulate(scene, maxSteps=program["steps"], maxIterations=1)
                if simulation is not None: break
                scene, _ = scenario.generate(maxIterations=300)
            else:
                return {"verdict": "rejected"}
            objects = list(scene.objects)
            found["actions"] = [
                [[str(objects.index(a)), plain(list(took) if isinstance(took, (tuple, list)) else [took])] for a, took in step.items()]
                for step in getattr(simulation, "result", simulation).actions
            ]
    except RejectionException:
        return {"verdict": "rejected"}
    except Exception as error:
        return {"verdict": "error", "message": str(error)[:120]}
    finally:
        if veneer.isActive(): veneer.deactivate()
    found["objects"] = [[float(o.position.x), float(o.position.y), float(o.heading), float(o.width), float(o.length)] for o in scene.objects]
    found["params"] = {k: plain(v) for k, v in scene.params.items()}
    return {"verdict": "ok", **found}

told = {}
for name, program in json.load(sys.stdin).items():
    with contextlib.redirect_stdout(io.StringIO()):
        first, second = once(program, 1), once(program, 2)
    certain = first == second and not program["random"]
    told[name] = first if certain or first["verdict"] == "error" else {"verdict": first["verdict"]}
json.dump(told, sys.stdout)
'''


def main(dialect: str, python: str, check: bool) -> int:
    """Write the record, or compare it; the exit code."""
    asked = {
        p["name"]: {"text": text_in(p["program"], d), "steps": p.get("steps"), "random": p.get("random", False)} for p, d in CASES if d == dialect
    }
    answer = subprocess.run([python, "-c", ASK], input=json.dumps(asked), capture_output=True, text=True, check=True)
    told, path = json.loads(answer.stdout), HERE / f"{dialect}.json"
    if not check:
        path.write_text(json.dumps(told, indent=0, sort_keys=True))
        return 0
    known = json.loads(Path(path).read_text())
    other = sorted(name for name in told.keys() | known.keys() if told.get(name) != known.get(name))
    print(f"{len(told) - len(other)} of {len(told)} programs: {dialect} says what it said" + (f"; not of {', '.join(other)}" if other else ""))
    return 1 if other else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:3], check="--check" in sys.argv))
