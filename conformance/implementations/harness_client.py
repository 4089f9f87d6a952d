"""Another implementation, behind a process that speaks the harness protocol (`docs/harness.md`): `External`."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import TracebackType
from typing import Any, Self

from .line_process import AnsweringProcess, ImplementationFault
from .protocol import NeverAccepted, Refused, SceneRecord, SimulationRecord, Task, Unsupported

PROTOCOL = "scenic-ref/harness/1"
START_SECONDS = 120.0
ANSWER_SECONDS = 60.0
"""How long an answer may take; scenes and simulations are answers each."""
REQUEST_SECONDS = 600.0
"""How long all answers to one request may take."""
PHASES = ("parse", "check", "resolve", "run")
LONGEST_WORDS = 2000
LARGEST = sys.float_info.max

Answer = Mapping[str, Any]


class External:
    """An implementation under test in a process of its own, which is started when it is needed and ended by `close`.

    `command` is the program with its arguments. `profile` are the readings that it is known to follow, besides those that it says itself.
    All that goes wrong on the other side is a `ImplementationFault`; the process is then ended, and the next question starts another.
    """

    def __init__(
        self, command: Sequence[str], *, profile: Mapping[str, str] | None = None, start: float = START_SECONDS, seconds: float = ANSWER_SECONDS
    ) -> None:
        self.command = tuple(command)
        self.start_seconds, self.seconds = start, seconds
        self.process: AnsweringProcess | None = None
        self.number = 0
        self.compiled: tuple[object, ...] | None = None
        self.simulated = False
        self.said: Answer = {}
        self.profile = dict(profile or {})

    def __enter__(self) -> Self:
        self.started()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    # what it says of itself

    @property
    def name(self) -> str:
        """The name and version of the implementation."""
        self.introduced()
        return f"{self.said['name']} {self.said['version']}"

    @property
    def dialects(self) -> tuple[str, ...]:
        """The dialects that it reads."""
        self.introduced()
        return tuple(self.said["dialects"])

    def follows(self, reading: str, alternative: str) -> bool:
        """Whether its profile has that alternative, or it says that it can be made to follow it."""
        self.introduced()
        able = self.said.get("readings", {}).get(reading, [])
        return self.profile.get(reading) == alternative or alternative in able

    def introduced(self) -> None:
        """Start the implementation unless it has introduced itself."""
        if not self.said:
            self.started()

    # the protocol

    def started(self) -> AnsweringProcess:
        """The process that runs, or a fresh one that has answered `start`."""
        if self.process is None:
            self.process = AnsweringProcess(self.command)
            self.compiled, self.simulated = None, False
            said = self.last(self.ask({"request": "start", "protocol": PROTOCOL}, self.start_seconds), "started")
            wrong = introduction_fault(said)
            if wrong:
                self.close()
                raise ImplementationFault("garbled", wrong)
            self.said = said
        return self.process

    def close(self) -> None:
        """End the implementation's process."""
        if self.process is not None:
            self.process.close()
            self.process = None

    def ask(self, request: Mapping[str, object], seconds: float) -> Iterator[Answer]:
        """The answers to a request. Whatever goes wrong, or is left in the middle, ends the process."""
        process = self.started()
        self.number += 1
        number, deadline, done = self.number, time.monotonic() + max(seconds, REQUEST_SECONDS), False
        try:
            process.ask(json.dumps({"id": number, **request}))
            while not done:
                left = deadline - time.monotonic()
                if left <= 0:
                    raise ImplementationFault("timed out", f"the answers took more than {max(seconds, REQUEST_SECONDS):g} s")
                answer = parse_answer(process.answer(min(seconds, left)), number)
                done = answer["answer"] not in ("scene", "simulation")
                yield answer
        finally:
            if not done:
                self.close()

    def last(self, answers: Iterator[Answer], wanted: str) -> Answer:
        """The only answer, of the wanted kind. Raises as `answer_or_raise` does."""
        answer = answer_or_raise(next(answers))
        for _ in answers:
            pass
        if answer["answer"] != wanted:
            self.close()
            raise ImplementationFault("garbled", f"the answer is {answer['answer']!r}, and not {wanted!r}")
        return answer

    def compile(self, task: Task) -> None:
        """The program is compiled, in a process in which no other was simulated. Raises `Refused`, `Unsupported`, `ImplementationFault`."""
        asked = {"request": "compile", "program": task.program, "dialect": task.dialect, "readings": dict(task.readings), "files": dict(task.files)}
        asked |= {} if task.prune else {"prune": False}
        key = (task.program, task.dialect, tuple(sorted(task.readings.items())), tuple(sorted(task.files.items())), task.prune)
        if self.simulated and self.said.get("isolated") is not True:
            self.close()
        self.started()
        if self.compiled == key and not self.simulated:
            return
        self.compiled = None
        _ = self.last(self.ask(asked, self.seconds), "compiled")
        self.compiled, self.simulated = key, False

    def scenes(self, task: Task, count: int, *, seed: int, attempts: int) -> Iterator[SceneRecord]:
        """`count` scenes. Raises `Refused`, `NeverAccepted`, `Unsupported` and `ImplementationFault`."""
        self.needs("scenes")
        self.compile(task)
        asked = {"request": "sample", "count": count, "seed": seed, "attempts": attempts}
        yield from self.records(asked, "scene", count, scene_fault)

    def simulations(
        self, task: Task, steps: int, count: int, *, seed: int, attempts: int, world: Sequence[object] | None = None
    ) -> Iterator[SimulationRecord]:
        """`count` simulations, in the world in which nothing moves or in a recorded one: for each time step, properties by objects' numbers."""
        self.needs("simulations")
        self.compile(task)
        self.simulated = True
        asked = {"request": "simulate", "steps": steps, "count": count, "seed": seed, "attempts": attempts, "world": world}
        yield from self.records(asked, "simulation", count, simulation_fault)

    def needs(self, capability: str) -> None:
        """Raise `Unsupported` if it says that it cannot do that."""
        self.introduced()
        if capability not in self.said["capabilities"]:
            raise Unsupported(f"{self.name} gives no {capability}")

    def records(
        self, asked: Mapping[str, object], key: str, count: int, fault: Callable[[object], str | None]
    ) -> Iterator[Mapping[str, object]]:
        """The scenes or simulations that a request gives. Raises `ImplementationFault` for what is none, and for more or less than were asked for."""
        answers = self.ask(asked, self.seconds)
        for number, answer in enumerate(answers):
            if answer_or_raise(answer)["answer"] == "done":
                if number < count:
                    self.close()
                    raise ImplementationFault("garbled", f"done after {number} of {count} {key}s")
                continue
            wrong = "too many" if number >= count else fault(answer.get(key))
            if wrong or answer["answer"] != key:
                self.close()
                raise ImplementationFault("garbled", f"a {key} {wrong}" if wrong else f"the answer is {answer['answer']!r}, and not {key!r}")
            yield answer[key]


def parse_answer(line: bytes, number: int) -> Answer:
    """An answer to the request of that number. Raises `ImplementationFault` for anything else."""
    try:
        answer = json.loads(line.decode(), parse_constant=not_json)
    except (ValueError, RecursionError) as error:
        raise ImplementationFault("garbled", f"{line_excerpt(line)} is not JSON: {error}") from None
    if not isinstance(answer, dict) or not isinstance(answer.get("answer"), str):
        raise ImplementationFault("garbled", f"{line_excerpt(line)} is not an answer")
    if answer.get("id") != number or isinstance(answer["id"], bool):
        raise ImplementationFault("garbled", f"an answer to request {line_excerpt(repr(answer.get('id')).encode())}, and {number} was asked")
    return answer


def not_json(constant: str) -> object:
    """Python reads NaN and infinities, which JSON does not have."""
    raise ValueError(f"{constant} is no number of JSON")


def line_excerpt(line: bytes) -> str:
    """The beginning of a line."""
    text = repr(line[:80].decode("utf-8", "replace").strip())
    return text if len(line) <= 80 else text + "..."


def answer_or_raise(answer: Answer) -> Answer:
    """The answer itself, or what it says raised: `Refused`, `NeverAccepted`, `Unsupported`, or an `ImplementationFault` of the other side's own."""
    match answer["answer"]:
        case "error":
            phase = answer.get("phase")
            if phase is not None and phase not in PHASES:
                raise ImplementationFault("garbled", f"there is no phase {phase!r}: there are {', '.join(PHASES)}")
            line = answer.get("line")
            raise Refused(
                phase, words(answer, "message"), class_name=answer.get("class"), rule=answer.get("rule"), line=line if type(line) is int else None,
                also=frozenset({"check"}) if phase == "parse" else frozenset(),
            )
        case "rejected":
            kinds = answer.get("requirements")
            raise NeverAccepted(frozenset(map(str, kinds)) if isinstance(kinds, list) else None)
        case "skipped":
            raise Unsupported(words(answer, "reason"))
        case "crashed":
            raise ImplementationFault("crashed", words(answer, "message"))
        case "started" | "compiled" | "scene" | "simulation" | "done" | "stopped":
            return answer
        case other:
            raise ImplementationFault("garbled", f"there is no answer {line_excerpt(other.encode())}")


def words(answer: Answer, key: str) -> str:
    """A text of an answer, cut where it is too long to be read."""
    text = answer.get(key)
    return (text if isinstance(text, str) else "no words")[:LONGEST_WORDS]


def introduction_fault(said: Answer) -> str | None:
    """Return the fault in an implementation's introduction; None if there is none."""
    texts = all(isinstance(said.get(key), str) for key in ("name", "version"))
    lists = all(isinstance(said.get(key), list) and all(isinstance(v, str) for v in said[key]) for key in ("dialects", "capabilities"))
    readings = said.get("readings", {})
    if said.get("protocol") != PROTOCOL:
        return f"it speaks {said.get('protocol')!r}, and not {PROTOCOL!r}"
    if not (texts and lists and said["dialects"] and isinstance(readings, dict) and all(isinstance(v, list) for v in readings.values())):
        return "it does not say its name, version, dialects and capabilities"
    return None


def scene_fault(scene: object) -> str | None:
    """Return the fault in a scene; None if there is none."""
    if not isinstance(scene, dict) or not isinstance(scene.get("objects"), list) or not isinstance(scene.get("params"), dict):
        return "has no objects or no params"
    for found in scene["objects"]:
        position = found.get("position") if isinstance(found, dict) else None
        if not (isinstance(position, list) and len(position) == 2 and all(map(is_finite, position)) and is_finite(found.get("heading"))):
            return "has an object without a position or a heading"
    ego = scene.get("ego")
    return None if ego is None or (type(ego) is int and 0 <= ego < len(scene["objects"])) else "has an ego that is none of its objects"


def simulation_fault(simulation: object) -> str | None:
    """Return the fault in a simulation; None if there is none."""
    if not isinstance(simulation, dict) or not isinstance(simulation.get("steps"), list) or not isinstance(simulation.get("result"), str):
        return "has no steps or no result"
    right = all(isinstance(step, dict) and isinstance(step.get("actions"), dict) for step in simulation["steps"])
    return None if right else "has a time step without actions"


def is_finite(value: object) -> bool:
    """Whether it is a number."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and -LARGEST <= value <= LARGEST
