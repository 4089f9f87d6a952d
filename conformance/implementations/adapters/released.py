"""The released Scenic, 2.1 and 3.x in its 2D mode, in the words of the harness protocol: run by a Python that has it installed.

It needs nothing but that release. Each program is compiled, sampled and simulated in a process of its own, forked from one that has imported
the release, so that nothing of one program is left for the next; where a system cannot fork, all are run in this one, and it says so.
"""

# pyright: reportMissingImports=false

from __future__ import annotations

import json
import math
import os
import random
import sys
import warnings
from contextlib import suppress

PROTOCOL = "scenic-ref/harness/1"
compiled = []
"""The scenario that was compiled last."""
FORKS = hasattr(os, "fork")
answers = os.fdopen(os.dup(1), "w", encoding="utf-8")  # the protocol's; what programs print goes to stderr
os.dup2(2, 1)
warnings.simplefilter("ignore")

import numpy  # noqa: E402
import scenic  # noqa: E402
import scenic.syntax.translator as translator  # noqa: E402
from scenic.core import errors  # noqa: E402
from scenic.core.distributions import RejectionException, Samplable  # noqa: E402
from scenic.core.simulators import DummySimulation, DummySimulator  # noqa: E402
from scenic.core.vectors import Vector  # noqa: E402

THREE = not hasattr(translator, "constructorStatements")
DIALECT = "scenic-3" if THREE else "scenic-2.1"
SPELLED = {"visibleDistance": "viewDistance"}
"""Properties of the release under the paper's names, where a program does not have one of that name besides."""


def to_plain_json(value, depth=0):
    """A value in JSON; what has no JSON form is {"repr": "..."}."""
    if isinstance(value, numpy.generic):
        value = value.item()
    if isinstance(value, bool) or value is None or type(value) is str:
        return value
    if isinstance(value, int):
        return int(value) if abs(value) < 1 << 1000 else {"repr": hex(value)}
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else {"repr": repr(float(value))}
    if type(value).__name__ == "Orientation":  # of 3 only
        return to_plain_json(float(value.yaw))
    if isinstance(value, Vector):
        return [to_plain_json(float(value.x)), to_plain_json(float(value.y))]
    if depth > 40:
        return {"repr": "..."}
    if isinstance(value, (list, tuple)):
        return [to_plain_json(v, depth + 1) for v in value]
    if isinstance(value, dict) and all(type(k) is str for k in value):
        return {k: to_plain_json(v, depth + 1) for k, v in value.items()}
    if hasattr(value, "position") and hasattr(value, "heading"):
        return {"repr": type(value).__name__}
    return {"repr": repr(value)[:200]}


def object_json(number, thing, names):
    """An object of a scene."""
    properties = {}
    for name in sorted(name for name in thing.properties if not name.startswith("_")):
        try:
            properties[name] = to_plain_json(getattr(thing, name))
        except Exception:  # a property that cannot be had is left out
            continue
    for name, spelled in SPELLED.items():
        if name in properties and spelled not in properties:
            properties[spelled] = properties.pop(name)
    for own in ("position", "heading", "width", "length"):
        properties.pop(own, None)
    return {
        "id": number, "name": names.get(id(thing)), "class": type(thing).__name__.removesuffix("2D"),
        "position": [float(thing.position.x), float(thing.position.y)], "heading": float(thing.heading),
        "width": float(thing.width), "length": float(thing.length), "properties": properties,
    }  # fmt: skip


def names_of(scene):
    """The variables of the program that hold objects."""
    found = {}
    for namespace in getattr(scene, "behaviorNamespaces", {}).values():
        for variables in namespace[:2] if isinstance(namespace, tuple) else (namespace,):
            if isinstance(variables, dict):
                found.update({id(value): name for name, value in variables.items() if not name.startswith("_")})
    return found


def scene_json(scene, seed, number, attempts):
    """A scene in the scene format."""
    names, objects = names_of(scene), list(scene.objects)
    ego = next((k for k, thing in enumerate(objects) if thing is scene.egoObject), None)
    if ego is not None:
        names[id(scene.egoObject)] = "ego"
    return {
        "schema": "scenic-ref/scene/1", "seed": seed, "scene": number, "attempts": attempts, "weight": 1.0,
        "params": {str(k): to_plain_json(v) for k, v in scene.params.items()}, "ego": ego,
        "objects": [object_json(k, thing, names) for k, thing in enumerate(objects)],
    }  # fmt: skip


def action_json(action):
    """An action: a plain value, or its class with its arguments."""
    value = to_plain_json(action)
    if isinstance(value, dict) and "repr" in value and hasattr(action, "__dict__"):
        return {"action": type(action).__name__, "args": [to_plain_json(v) for v in vars(action).values()]}
    return value


def world_of(recorded):
    """A simulator in which nothing moves, or everything as it was recorded: a time step takes one second."""

    class InRecordedWorld(DummySimulation):
        passed = -1  # 2.1 counts a time step after the world has been asked

        def updateObjects(self):
            self.passed += 1
            super().updateObjects()

        def getProperties(self, obj, properties):
            values = super().getProperties(obj, properties)
            number = str(list(self.objects).index(obj))
            pose = recorded[self.passed].get(number, {}) if recorded and self.passed < len(recorded) else {}
            for name, value in pose.items():
                own = "yaw" if THREE and name == "heading" else name
                if own in values:
                    values[own] = Vector(*value) if isinstance(value, list) else value
            return values

    class World(DummySimulator):
        def createSimulation(self, scene, **options):
            if not THREE:
                options["timestep"] = 1
            return InRecordedWorld(scene, **options)

    return World()


def simulation_json(simulation, scene):
    """A simulation in the simulation format."""
    result = simulation.result
    number = {id(thing): k for k, thing in enumerate(simulation.objects)}
    actions = [
        {str(number[id(agent)]): list(map(action_json, took if isinstance(took, (tuple, list)) else [took])) for agent, took in step.items()}
        for step in result.actions
    ]
    actions = [{agent: taken for agent, taken in step.items() if taken not in ([], [None])} for step in actions]
    steps = []
    for k, state in enumerate(result.trajectory):
        objects = [{"id": i, "position": to_plain_json(position)} for i, position in enumerate(positions_in(state))]
        steps.append({"step": k, "objects": objects, "actions": actions[k] if k < len(actions) else {}, "events": [], "doing": {}})
    ended = "time limit" if result.terminationType.name == "timeLimit" else "terminated"
    return {
        "schema": "scenic-ref/simulation/1", "seed": 0, "run": 0, "attempts": 1, "timestep": 1, "scene": scene, "created": [],
        "steps": steps, "result": ended, "reason": str(result.terminationReason),
    }  # fmt: skip


def positions_in(state):
    """The positions in a recorded state: 2.1 records them alone, 3 with the orientations."""
    return getattr(state, "positions", state)


# requests


def compile_program(request):
    """Compile a program; modules beside it are written to the folder in which this process runs."""
    if request["dialect"] != DIALECT:
        return {"answer": "skipped", "reason": f"this release reads {DIALECT}, not {request['dialect']}"}
    folder = os.path.join(os.getcwd(), f"program-{os.getpid()}")
    os.makedirs(folder, exist_ok=True)
    for path, text in request.get("files", {}).items():
        os.makedirs(os.path.dirname(os.path.join(folder, path)), exist_ok=True)
        with open(os.path.join(folder, path), "w", encoding="utf-8") as file:
            file.write(text)
    main = os.path.join(folder, "program.scenic")
    with open(main, "w", encoding="utf-8") as file:
        file.write(request["program"])
    os.chdir(folder)
    sys.path.insert(0, folder)
    translator.usePruning = request.get("prune", True)
    compiled[:] = [scenic.scenarioFromFile(main, **({"mode2D": True} if THREE else {}))]
    return {"answer": "compiled"}


def seed_generators(request):
    """All that is random from here on follows from the seed."""
    random.seed(request["seed"])
    numpy.random.seed(request["seed"] % (1 << 32))


in_draws = [0]
"""Attempts that failed within a draw, such as that of a point of an intersection: the program's own attempts are those beside them."""
sample_all = Samplable.sampleAll


def sample_counting_rejections(quantities):
    """All draws of an attempt."""
    try:
        return sample_all(quantities)
    except RejectionException:
        in_draws[0] += 1
        raise


Samplable.sampleAll = staticmethod(sample_counting_rejections)


def sample(request, say):
    """As many scenes as are wanted."""
    seed_generators(request)
    for number in range(request["count"]):
        in_draws[0] = 0
        scene, attempts = compiled[0].generate(maxIterations=request["attempts"])
        say({"answer": "scene", "scene": scene_json(scene, request["seed"], number, attempts - in_draws[0])})
    return {"answer": "done"}


def simulate(request, say):
    """As many simulations as are wanted; after a rejected one a new scene is drawn, as the releases' command lines do."""
    seed_generators(request)
    for _ in range(request["count"]):
        for _ in range(request["attempts"]):
            scene, attempts = compiled[0].generate(maxIterations=request["attempts"])
            told = scene_json(scene, request["seed"], 0, attempts)
            run = world_of(request.get("world")).simulate(scene, maxSteps=request["steps"], maxIterations=1)
            if run is not None:
                break
        else:
            return {"answer": "rejected"}
        say({"answer": "simulation", "simulation": simulation_json(run, told)})
    return {"answer": "done"}


def final_answer(request, say):
    """The last answer to a request; what the release raises is the program's error."""
    try:
        if request["request"] == "compile":
            return compile_program(request)
        if not compiled:
            return {"answer": "crashed", "message": "no program was compiled"}
        return (sample if request["request"] == "sample" else simulate)(request, say)
    except RejectionException:
        return {"answer": "rejected"}
    except (MemoryError, SystemExit) as error:
        return {"answer": "crashed", "message": error_text(error)}
    except Exception as error:
        return error_json(error)


def error_text(error):
    """The class of an exception and what it says: nothing where a method of the program is to say it and fails."""
    try:
        return f"{type(error).__name__}: {error}"
    except Exception:
        return type(error).__name__


def error_json(error):
    """An error, with its phase where the release tells it."""
    runtime = getattr(errors, "RuntimeParseError", ())
    parse = isinstance(error, (errors.ScenicSyntaxError, SyntaxError)) and not isinstance(error, runtime)
    phase = "parse" if parse else None
    line = getattr(error, "lineno", None)
    message = error_text(error)
    return {"answer": "error", "phase": phase, "message": message, **({"line": line} if type(line) is int else {})}


def describe_release():
    """Describe this implementation for the protocol."""
    version = getattr(scenic, "__version__", None)
    if version is None:
        from importlib.metadata import version as installed

        version = installed("scenic")
    return {
        "answer": "started", "protocol": PROTOCOL, "name": "scenic", "version": version, "dialects": [DIALECT],
        "capabilities": ["scenes", "attempts", "simulations"], "isolated": FORKS,
    }  # fmt: skip


def answer_writer(number):
    """A function that answers the request of that number."""

    def say(answer):
        answers.write(json.dumps({"id": number, **answer}, allow_nan=False) + "\n")
        answers.flush()

    return say


def answer_line(line):
    """Answer a request about a program."""
    request = json.loads(line)
    say = answer_writer(request["id"])
    say(final_answer(request, say))


class Child:
    """A fork that answers the requests about one program; each ends with a byte on a pipe, so that a crash is noticed."""

    def __init__(self):
        out, self.requests = os.pipe()
        self.ended, done = os.pipe()
        self.pid = os.fork()
        if self.pid == 0:
            os.close(self.requests)
            os.close(self.ended)
            try:
                for line in os.fdopen(out, encoding="utf-8"):
                    answer_line(line)
                    os.write(done, b".")
                os._exit(0)
            finally:
                os._exit(1)
        os.close(out)
        os.close(done)
        self.alive = True

    def answer(self, line, number):
        """Let it answer; if it ends instead, that is the answer."""
        with suppress(BrokenPipeError):
            for part in range(0, len(line), 4096):
                os.write(self.requests, line[part : part + 4096].encode())
        if not os.read(self.ended, 1):
            _, status = os.waitpid(self.pid, 0)
            self.alive = False
            answer_writer(number)(
                {"answer": "crashed", "message": f"the process of the program ended with exit code {os.waitstatus_to_exitcode(status)}"}
            )

    def close(self):
        """End the child process."""
        os.close(self.requests)
        os.close(self.ended)
        if self.alive:
            os.kill(self.pid, 9)
            os.waitpid(self.pid, 0)


def main():
    """Answer until `stop`, or the end of the input."""
    child = None
    for line in sys.stdin:
        request = json.loads(line)
        say = answer_writer(request["id"])
        if request["request"] == "start":
            say(describe_release())
        elif request["request"] == "stop":
            say({"answer": "stopped"})
            return
        elif not FORKS:
            answer_line(line)
        else:
            if request["request"] == "compile" or child is None or not child.alive:
                if child is not None:
                    child.close()
                child = Child()
            child.answer(line, request["id"])


if __name__ == "__main__":
    main()
