"""Another implementation behind a process: what it answers is judged, and whatever goes wrong there ends in a verdict of its own."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import scenic_ref.conformance.implementations.harness_client as external
from scenic_ref.conformance import NeverAccepted, Refused, Task, judge, load_vectors
from scenic_ref.conformance.implementations import line_process as processes
from scenic_ref.conformance.implementations.harness_client import External
from scenic_ref.conformance.implementations.line_process import ImplementationFault as Fault
from scenic_ref.conformance.implementations.protocol import Unsupported

HERE = Path(__file__).parent
ROOT = HERE.parent.parent
SCENE = {"params": {}, "ego": 0, "objects": [{"position": [1, 2], "heading": 0.0, "properties": {}}]}
TASK = Task("ego = Object at 1 @ 2\n", "paper")

FAKE = '''
import json, os, signal, sys
HOW = {how!r}
SCENE = {scene!r}
def say(id, **answer):
    print(json.dumps({{"id": id, **answer}}), flush=True)
count = 0
for line in sys.stdin:
    asked = json.loads(line)
    id, request = asked["id"], asked["request"]
    if request == "start":
        say(id, answer="started", protocol="scenic-ref/harness/1", name="fake", version="1", dialects=["paper"],
            capabilities=["scenes", "simulations"], readings={{"soft": ["scene"]}})
        continue
    if request == "compile":
        count += 1
        exec(HOW.get("compile", "say(id, answer='compiled')"))
        continue
    if request == "stop":
        break
    exec(HOW.get(request, "[say(id, answer='scene', scene=SCENE) for _ in range(asked['count'])]; say(id, answer='done')"))
'''


class Clock:
    """The time of the limits: it stands still unless a test lets it pass."""

    def __init__(self) -> None:
        self.now = self.pace = 0.0
        self.looked = threading.Event()

    def monotonic(self) -> float:
        self.looked.set()
        self.now += self.pace
        return self.now

    def fly(self) -> None:
        """From now on every look finds it two seconds later."""
        self.pace = 2.0

    def pass_by(self, seconds: float) -> None:
        self.now += seconds
        self.looked.clear()


@pytest.fixture(autouse=True)
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    """No limit of time passes on a busy machine."""
    clock = Clock()
    for module in (external, processes):
        monkeypatch.setattr(module, "time", clock)
    return clock


class Living:
    """A named pipe that processes hold open for writing as long as they live: both its ends are events."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / "living"
        os.mkfifo(self.path)
        self.held = f"living = os.open({str(self.path)!r}, os.O_WRONLY)"
        """The statement by which a process holds it, and those that it starts."""

    def begin(self) -> None:
        """Wait until a process holds it."""
        self.end = self.path.open("rb")

    def all_end(self) -> None:
        """Wait until nobody holds it any more."""
        with self.end as end:
            assert end.read() == b""

    def then(self, what: Callable[[], None]) -> threading.Thread:
        """A thread that does something once a process holds it."""

        def wait() -> None:
            self.begin()
            what()

        thread = threading.Thread(target=wait, daemon=True)
        thread.start()
        return thread


@pytest.fixture
def living(tmp_path: Path) -> Living:
    return Living(tmp_path)


def fake(seconds: float = 20.0, **how: str) -> External:
    """An implementation of which some requests are answered as these statements say."""
    return External([sys.executable, "-c", FAKE.format(how=how, scene=SCENE)], seconds=seconds)


def drawn(implementation: External, count: int = 2, task: Task = TASK) -> list[Any]:
    return list(implementation.scenes(task, count, seed=1, attempts=10))


ONE = "say(id, answer='scene', scene=SCENE); say(id, answer='done')"
FAULTS = {
    "crashes": ({"sample": "os._exit(7)"}, "crashed: exit code 7"),
    "is killed": ({"sample": "os.kill(os.getpid(), 9)"}, "crashed: signal 9"),
    "raises": ({"sample": "1 / 0"}, "crashed: exit code 1: ZeroDivisionError: division by zero"),
    "crashes behind a scene": ({"sample": "say(id, answer='scene', scene=SCENE); os._exit(3)"}, "crashed: exit code 3"),
    "crashes when it compiles": ({"compile": "os._exit(7)"}, "crashed: exit code 7"),
    "closes its output": ({"sample": "sys.stdout.close(); os.close(1); signal.pause()"}, "crashed: it closed its output"),
    "says that it crashed": ({"sample": "say(id, answer='crashed', message='of old age')"}, "crashed: of old age"),
    "prints garbage": ({"sample": "print('hello', flush=True)"}, "garbled: 'hello' is not JSON"),
    "prints bytes": ({"sample": "sys.stdout.buffer.write(bytes(range(128, 200)) + b'\\n'); sys.stdout.flush()"}, "garbled: '\ufffd"),
    "prints a zero": ({"sample": "print('\\0{{', flush=True)"}, "garbled: '\\x00{{' is not JSON: Expecting value"),
    "prints a list": ({"sample": "print('[1]', flush=True)"}, "garbled: '[1]' is not an answer"),
    "nests deeply": ({"sample": "print('[' * 200000, flush=True)"}, "garbled: "),
    "prints a long number": ({"sample": "print('1' * 10000, flush=True)"}, "garbled: "),
    "answers out of order": ({"sample": "say(id - 1, answer='done')"}, "garbled: an answer to request '2', and 3 was asked"),
    "answers without a number": ({"sample": "print('{\"answer\": \"done\"}', flush=True)"}, "garbled: an answer to request 'None'"),
    "answers something else": ({"sample": "say(id, answer='maybe')"}, "garbled: there is no answer 'maybe'"),
    "compiles to a scene": ({"compile": "say(id, answer='scene', scene=SCENE); say(id, answer='done')"}, "garbled: the answer is 'scene'"),
    "gives too few": ({"sample": "say(id, answer='done')"}, "garbled: done after 0 of"),
    "says NaN": ({"sample": "print('{\"id\": %d, \"answer\": \"scene\", \"scene\": NaN}' % id, flush=True)"}, "garbled: "),
    "has a scene without objects": ({"sample": "say(id, answer='scene', scene={})"}, "garbled: a scene has no objects or no params"),
    "has an object nowhere": ({"sample": "SCENE['objects'][0]['position'][1] = None; " + ONE}, "garbled: a scene has an object"),
    "has an infinite position": ({"sample": "SCENE['objects'][0]['position'][1] = 10**400; " + ONE}, "garbled: a scene has an object"),
    "has an ego that is not there": ({"sample": "say(id, answer='scene', scene=dict(SCENE, ego=4))"}, "garbled: a scene has an ego"),
    "names a wrong phase": ({"compile": "say(id, answer='error', phase='lunch', message='')"}, "garbled: there is no phase 'lunch'"),
}  # fmt: skip


@pytest.mark.sampled(3)
@pytest.mark.parametrize("fault", FAULTS)
def test_every_fault_has_its_verdict_and_the_next_question_is_answered(fault: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    how, words = FAULTS[fault]
    monkeypatch.setattr(processes, "PATIENCE", 0.1 if fault == "closes its output" else 600.0)  # the former never ends by itself
    vector = next(v for v in load_vectors() if v.kind == "values" and "paper" in v.texts and not v.readings)
    with fake(**how) as implementation:
        verdict = judge(implementation, vector).verdict
        assert verdict.status == "errored" and verdict.reason.startswith(words)
    flag = tmp_path / "once"
    (request, text), usual = next(iter(how.items())), {"compile": "say(id, answer='compiled')", "sample": ONE}
    once = f"\nif os.path.exists({str(flag)!r}):\n    {usual[request]}\nelse:\n    open({str(flag)!r}, 'w').close()\n    {text}"
    with fake(**{request: once}) as implementation:
        with pytest.raises(Fault) as raised:
            drawn(implementation, 1)
        assert str(raised.value).startswith(words)
        assert drawn(implementation, 1) == [SCENE]
        process = implementation.process
    assert process is not None and process.child.poll() is not None


@pytest.mark.parametrize("leaves", [False, True])
@pytest.mark.skipif(not Path("/proc").exists(), reason="only Linux tells the surroundings of a process")
def test_a_hang_ends_and_takes_its_children_with_it(leaves: bool, clock: Clock, living: Living) -> None:
    child = f"import subprocess; {living.held}; subprocess.Popen(['sleep', 'infinity'], pass_fds=[living], start_new_session={leaves})"
    held = living.then(clock.fly)
    how = f"{child}; os.close(living); signal.pause()"
    with fake(seconds=1.0, sample=how) as hung, pytest.raises(Fault, match="timed out: no answer within 1 s"):
        drawn(hung)
    held.join()
    living.all_end()


def test_one_who_does_not_read_is_no_hang_of_ours(clock: Clock, living: Living) -> None:
    held = living.then(clock.fly)
    program = Task("ego = Object" + " " * (1 << 20), "paper")  # more than a pipe holds
    deaf = FAKE.format(how={}, scene=SCENE).replace("        continue\n", f"        {living.held}; signal.pause()\n", 1)
    with External([sys.executable, "-c", deaf], seconds=1.0) as implementation, pytest.raises(Fault, match="timed out: no answer within 1 s"):
        drawn(implementation, 1, program)
    held.join()
    living.all_end()


@pytest.mark.skipif(sys.platform == "win32", reason="there is no guard")
def test_nothing_is_left_when_this_process_is_killed(living: Living) -> None:
    ours = (
        "import sys\nfrom scenic_ref.conformance.implementations.harness_client import External\nfrom scenic_ref.conformance import Task\n"
        f"other = External([sys.executable, '-c', {FAKE.format(how={'sample': f'{living.held}; signal.pause()'}, scene=SCENE)!r}])\n"
        "list(other.scenes(Task('ego = Object', 'paper'), 1, seed=1, attempts=1))\n"
    )
    with subprocess.Popen([sys.executable, "-c", ours]) as process:
        living.begin()
        process.kill()
    living.all_end()


def test_scenes_that_come_for_ever_end(clock: Clock) -> None:
    for_ever = "\nwhile True:\n    say(id, answer='scene', scene=SCENE)"
    with fake(sample=for_ever) as implementation, pytest.raises(Fault, match="garbled: a scene too many"):
        drawn(implementation, 3)
    with fake(sample=for_ever) as implementation, pytest.raises(Fault, match="timed out: the answers took more than 600 s"):
        for _ in implementation.scenes(TASK, 1 << 30, seed=1, attempts=1):
            clock.pass_by(100.0)


def test_a_line_without_end_and_a_folder_that_grows(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(processes, "LONGEST_LINE", 1 << 16)
    with fake(sample="\nwhile True:\n    sys.stdout.write('x' * 4096)") as implementation, pytest.raises(Fault, match="garbled: a line of more than"):
        drawn(implementation)
    monkeypatch.setattr(processes, "LARGEST_FOLDER", 1 << 20)
    fill = "\nfor k in range(8):\n    open(f'file{k}', 'w').write('x' * 500000)\nsignal.pause()"
    with fake(sample=fill) as implementation, pytest.raises(Fault, match="crashed: it wrote more than"):
        drawn(implementation)


def test_its_folder_is_its_own_and_is_deleted(tmp_path: Path) -> None:
    place = tmp_path / "folder"
    write = f"open({str(place)!r}, 'w').write(os.getcwd()); open('left', 'w').write('x'); {ONE}"
    with fake(sample=write) as implementation:
        drawn(implementation, 1)
    assert place.read_text() and not Path(place.read_text()).exists()


@pytest.mark.skipif(sys.platform == "win32", reason="there are no such limits")
def test_its_memory_and_its_files_are_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(processes, "LARGEST_MEMORY", 1 << 30)
    with fake(sample="x = bytearray(2 << 30); say(id, answer='done')") as it, pytest.raises(Fault, match="crashed: exit code 1: MemoryError"):
        drawn(it)
    monkeypatch.setattr(processes, "LARGEST_FOLDER", 1 << 20)
    with fake(sample="open('big', 'wb').write(bytes(4 << 20)); say(id, answer='done')") as it, pytest.raises(Fault, match="crashed"):
        drawn(it)


def test_a_slow_start_is_waited_for(clock: Clock, tmp_path: Path) -> None:
    gate = tmp_path / "gate"
    os.mkfifo(gate)

    def thirty_seconds_later() -> None:
        with gate.open("w"):  # it has begun
            clock.pass_by(30.0)
            clock.looked.wait()

    slow = External([sys.executable, "-c", f"open({str(gate)!r}).read()\n" + FAKE.format(how={}, scene=SCENE)], seconds=1.0)
    opening = threading.Thread(target=thirty_seconds_later, daemon=True)
    opening.start()
    with slow:
        assert len(drawn(slow, 3)) == 3
    opening.join()


def test_a_start_that_takes_too_long(clock: Clock, living: Living) -> None:
    late = External([sys.executable, "-c", f"import os, signal; {living.held}; signal.pause()"], start=1.0)
    held = living.then(clock.fly)
    with pytest.raises(Fault, match="timed out: no answer within 1 s"):
        late.started()
    held.join()
    living.all_end()
    assert late.process is None


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        ("{'answer': 'started', 'protocol': 'other'}", "garbled: it speaks 'other'"),
        ("{'answer': 'started', 'protocol': 'scenic-ref/harness/1', 'name': 'x'}", "garbled: it does not say its name, version"),
        ("{'answer': 'done'}", "garbled: the answer is 'done', and not 'started'"),
    ],
)
def test_an_introduction_must_be_whole(answer: str, words: str) -> None:
    program = f"import json, sys\nid = json.loads(sys.stdin.readline())['id']\nprint(json.dumps(dict({answer}, id=id)), flush=True)\nsys.stdin.read()"
    implementation = External([sys.executable, "-c", program])
    with pytest.raises(Fault) as raised:
        implementation.started()
    assert str(raised.value).startswith(words)
    with pytest.raises(Fault, match="garbled"):  # it is asked again: what it said was not kept
        _ = implementation.name
    assert implementation.process is None


def test_a_command_that_is_no_program() -> None:
    with pytest.raises(Fault, match="crashed: "):
        External(["/nowhere/at/all"]).started()


def test_answers_are_told_apart() -> None:
    with fake() as implementation:
        assert drawn(implementation, 3) == [SCENE] * 3
        assert implementation.name == "fake 1" and implementation.dialects == ("paper",)
        assert implementation.follows("soft", "scene") and not implementation.follows("soft", "attempt")
    with fake(compile="say(id, answer='error', phase='parse', message='no', line=3)") as implementation:
        with pytest.raises(Refused, match="no") as raised:
            drawn(implementation)
        assert (raised.value.phase, raised.value.line) == ("parse", 3)
        assert raised.value.may_be_in(["check"]) and not raised.value.may_be_in(["run"])
    with fake(sample="say(id, answer='error', message='no')") as implementation, pytest.raises(Refused) as raised:
        drawn(implementation)
    assert raised.value.phase is None and raised.value.may_be_in(["run"]) and raised.value.when == "refused"
    with fake(sample="say(id, answer='rejected', requirements=['collision'])") as implementation, pytest.raises(NeverAccepted) as never:
        drawn(implementation)
    assert never.value.requirements == {"collision"}
    with fake(compile="say(id, answer='skipped', reason='too hard')") as implementation, pytest.raises(Unsupported, match="too hard"):
        drawn(implementation)


def test_a_program_is_compiled_once_and_simulated_in_a_process_of_its_own() -> None:
    told = "say(id, answer='scene', scene=dict(SCENE, params={'compiled': count, 'process': os.getpid()})); say(id, answer='done')"
    ran = "say(id, answer='simulation', simulation={'steps': [{'actions': {}}], 'result': 'terminated'}); say(id, answer='done')"
    with fake(sample=told, simulate=ran) as implementation:
        first, second = (drawn(implementation, 1)[0]["params"] for _ in range(2))
        assert first == second and first["compiled"] == 1
        assert drawn(implementation, 1, Task("ego = Object\n", "paper"))[0]["params"]["compiled"] == 2
        assert len(list(implementation.simulations(TASK, 3, 1, seed=1, attempts=1))) == 1
        after = drawn(implementation, 1)[0]["params"]
        assert after["process"] != first["process"] and after["compiled"] == 1


def test_an_interrupt_leaves_no_process() -> None:
    with fake(sample="say(id, answer='scene', scene=SCENE); signal.pause()") as implementation:
        scenes = implementation.scenes(TASK, 2, seed=1, attempts=1)
        next(scenes)
        process = implementation.process
        assert process is not None
        scenes.close()
        assert implementation.process is None and process.child.poll() == -signal.SIGKILL


NODE = shutil.which("node")


def test_the_documentation_shows_the_minimal_implementation() -> None:
    assert (ROOT / "examples" / "harness" / "minimal.js").read_text() in (ROOT / "docs" / "harness.md").read_text()


@pytest.mark.skipif(NODE is None, reason="node is not installed")
def test_the_minimal_implementation_of_the_documentation() -> None:
    assert NODE is not None
    with External([NODE, str(ROOT / "examples" / "harness" / "minimal.js")]) as minimal:
        scenes = list(minimal.scenes(Task("ego = Object at (Range(1, 2), -3.5)", "paper"), 200, seed=3, attempts=1))
        places = [scene["objects"][0]["position"] for scene in scenes]  # type: ignore[index]
        assert all(1 <= x <= 2 and y == -3.5 for x, y in places) and len({x for x, _ in places}) == 200
        statuses = [judge(minimal, vector).verdict.status for vector in load_vectors()[:40]]
        assert set(statuses) == {"skipped"}


def test_the_schema_is_that_of_what_is_said() -> None:
    jsonschema = pytest.importorskip("jsonschema")
    schema = json.loads((ROOT / "conformance" / "implementations" / "adapters" / "harness.schema.json").read_text())
    validator = jsonschema.Draft202012Validator(schema)
    validator.check_schema(schema)
    right: list[dict[str, Any]] = [
        {"id": 1, "request": "start", "protocol": external.PROTOCOL},
        {"id": 2, "request": "compile", "program": "ego = Object", "dialect": "paper", "readings": {"soft": "scene"}, "files": {}},
        {"id": 3, "request": "sample", "count": 2, "seed": 5, "attempts": 10},
        {"id": 4, "request": "simulate", "steps": 2, "count": 2, "seed": 5, "attempts": 10, "world": [{"0": {"position": [1, 2], "heading": 0}}]},
        {"id": 5, "request": "stop"},
        {"id": 1, "answer": "started", "protocol": external.PROTOCOL, "name": "x", "version": "1", "dialects": ["paper"], "capabilities": ["scenes"]},
        {"id": 2, "answer": "compiled"}, {"id": 3, "answer": "done"}, {"id": 3, "answer": "scene", "scene": SCENE},
        {"id": 4, "answer": "simulation", "simulation": {"steps": [{"actions": {"0": [1]}}], "result": "terminated"}},
        {"id": 2, "answer": "error", "phase": None, "message": "no"}, {"id": 2, "answer": "rejected"}, {"id": 2, "answer": "skipped", "reason": "x"},
        {"id": 2, "answer": "crashed", "message": "x"},
    ]  # fmt: skip
    for message in right:
        validator.validate(message)
    wrong = [
        {"id": 0, "answer": "done"}, {"answer": "done"}, {"id": 1, "answer": "scene"}, {"id": 1, "request": "sample"},
        {"id": 1, "answer": "error", "phase": "lunch", "message": ""},
    ]  # fmt: skip
    for message in wrong:
        assert not validator.is_valid(message), message
