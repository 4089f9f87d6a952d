"""`simulate --simulator package.module:Class`: a simulator of the user's own, from the current folder or installed."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

RAILS = '''
from scenic_ref.semantics.space.vectors import Vector
from scenic_ref.simulators import EndRun, RejectRun

class Rails:
    properties = frozenset({"position"})
    random = False

    def __init__(self, timestep=0.5):
        self.timestep = timestep
        self.bodies = {}

    def create(self, bodies, scene):
        for body in bodies:
            if body.properties["position"].x > scene.params.get("east", 0.5):
                raise RejectRun("no place to spawn")
            self.bodies[body.id] = body.properties["position"]

    def check(self, body, action):
        return None if isinstance(action, (int, float)) else "it is not a speed"

    def step(self, actions):
        for id, taken in actions.items():
            self.bodies[id] = self.bodies[id] + Vector(0.0, taken[-1] * self.timestep)
        if any(position.y >= 6 for position in self.bodies.values()):
            raise EndRun("episode done", ["the end of the rails"])
        return []

    def read(self, id):
        return {"position": self.bodies[id]}

    def destroy(self):
        self.bodies = {}

def made(timestep=2.0):
    return Rails(timestep)

class Fixed(Rails):
    def __init__(self):
        super().__init__(0.25)

class Broken(Rails):
    def __init__(self, timestep=1.0):
        raise OSError("no license")

class Nothing:
    pass

instance = Rails()
'''
PROGRAM = """
behavior B():
    while True:
        take 2
ego = Object at (Range(0, 1), 0), with behavior B
"""


@pytest.fixture
def rails(ask, tmp_path, monkeypatch):
    """Answers `simulate`, in a folder with the module `own.rails`, which nobody has imported."""
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "__init__.py").write_text("")
    (tmp_path / "own" / "rails.py").write_text(RAILS)
    (tmp_path / "p.scenic").write_text(PROGRAM)
    for name in [name for name in sys.modules if name.split(".")[0] == "own"]:
        monkeypatch.delitem(sys.modules, name)
    before = list(sys.path)
    yield lambda *arguments: ask("simulate", "p.scenic", *arguments)
    assert sys.path == before
    for name in [name for name in sys.modules if name.split(".")[0] == "own"]:
        monkeypatch.delitem(sys.modules, name)


def lines(path):
    return [json.loads(line) for line in path.read_text().splitlines()]


def test_it_rejects_and_ends_and_has_all_outputs(rails, tmp_path):
    done = rails("--simulator", "own.rails:Rails", "-n", 6, "-o", "runs.jsonl", "--html", "r.html", "--gif", "r.gif")
    assert done.code == 0, done.err
    runs = lines(tmp_path / "runs.jsonl")
    ends = {(run["result"], run["reason"], run["timestep"], len(run["steps"])) for run in runs}
    assert ends == {("ended by the simulator", "episode done", 0.5, 7)}
    assert all(run["steps"][5]["events"] == ["the end of the rails"] and run["steps"][6]["actions"] == {} for run in runs)
    assert all(run["scene"]["objects"][0]["position"][0] <= 0.5 for run in runs)
    attempts = sum(run["attempts"] for run in runs)
    assert attempts > 6
    assert f"6 simulations of seed 0 in {attempts} attempts" in done.err
    assert f"{attempts - 6:>9}  100%  the simulator rejected the run: no place to spawn (in time step 0)" in done.err
    assert '"ended by the simulator"' in (tmp_path / "r.html").read_text()
    assert (tmp_path / "r.gif").read_bytes().startswith(b"GIF8")


def test_its_recordings_replay_equally(rails, tmp_path):
    assert rails("--simulator", "own.rails:Rails", "--dt", "0.75", "-n", 3, "-o", "runs.jsonl").code == 0
    done = rails("--simulator", "own.rails:Rails", "--replay", "runs.jsonl", "-o", "again.jsonl")
    assert done.code == 0, done.err
    assert "3 simulations of runs.jsonl replayed in own.rails:Rails" in done.err
    assert "all states are equal to the recorded ones" in done.err
    recorded, again = lines(tmp_path / "runs.jsonl"), lines(tmp_path / "again.jsonl")
    assert again == recorded
    assert again[0]["timestep"] == 0.75


def test_a_replay_tells_what_was_rejected_and_what_was_ended_early(ask, rails, tmp_path):
    assert ask("simulate", "p.scenic", "-n", 12, "--steps", 20, "-o", "runs.jsonl").code == 0
    done = rails("--simulator", "own.rails:Rails", "--replay", "runs.jsonl", "-o", "again.jsonl")
    assert done.code == 0, done.err
    xs = [run["scene"]["objects"][0]["position"][0] for run in lines(tmp_path / "runs.jsonl")]
    out = [number for number, x in enumerate(xs, 1) if x > 0.5]
    early = [number for number, x in enumerate(xs, 1) if x <= 0.5]
    assert 0 < len(out) < 12
    assert "12 simulations of runs.jsonl replayed in own.rails:Rails" in done.err
    reason = "the replay fails in time step 0: the simulator rejected the run: no place to spawn"
    assert f"rejected, and left out: {len(out)}, first that of line {out[0]}: {reason}" in done.err
    assert f"ended by the simulator before the recording: {len(early)}, first that of line {early[0]}, after 3 time steps: episode done" in done.err
    assert "with the recorded states in all time steps: 0 of 12" in done.err
    again = lines(tmp_path / "again.jsonl")
    assert [run["run"] for run in again] == [number - 1 for number in early]
    assert {(run["result"], len(run["steps"])) for run in again} == {("ended by the simulator", 4)}


def test_if_all_replays_are_rejected_the_exit_code_is_that_of_exhausted_attempts(ask, rails, tmp_path):
    assert ask("simulate", "p.scenic", "-n", 2, "-o", "runs.jsonl", "-p", "east=-1").code == 0
    done = rails("--simulator", "own.rails:Rails", "--replay", "runs.jsonl", "-p", "east=-1", "-o", "again.jsonl")
    assert done.code == 3
    assert "own.rails:Rails rejected all simulations of runs.jsonl" in done.err
    assert (tmp_path / "again.jsonl").read_text() == ""


def test_after_the_last_attempt_the_exit_code_is_3(rails):
    done = rails("--simulator", "own.rails:Rails", "-p", "east=-1", "--max-attempts", 4)
    assert done.code == 3
    assert "each time this failed in time step 0: the simulator rejected the run: no place to spawn" in done.err


def test_it_is_made_with_the_time_step_that_is_given(rails):
    for name, more, timestep in (("Rails", (), 0.5), ("Rails", ("--dt", "3"), 3.0), ("made", (), 2.0), ("Fixed", (), 0.25)):
        done = rails("--simulator", f"own.rails:{name}", "--steps", 0, *more)
        assert json.loads(done.out)["timestep"] == timestep


@pytest.mark.parametrize(
    ("name", "more", "message"),
    [
        ("own.nowhere:Rails", (), "there is no module own.nowhere"),
        ("nowhere.rails:Rails", (), "there is no module nowhere"),
        ("own.rails:Trains", (), "the module own.rails has no Trains"),
        ("own.rails:Nothing", (), "own.rails:Nothing is not a simulator: a simulator is needed, but a Nothing has no method create, check"),
        ("own.rails:instance", (), "own.rails:instance makes no simulator: it is a Rails"),
        ("own.rails:Broken", (), "the simulator own.rails:Broken cannot be made: Broken() failed: OSError: no license"),
        ("own.rails:Fixed", ("--dt", "2"), "Fixed(timestep=2.0) failed: TypeError"),
        ("own.rails:made", ("--dt", "-2"), "the timestep of a simulator must be a positive number of seconds, not -2.0"),
        ("own.rails:", (), "own.rails: does not name a simulator"),
        ("own/rails.py:Rails", (), "does not name a simulator"),
        ("own.wrong:Rails", (), "the module own.wrong cannot be imported: SyntaxError"),
        ("own.lacking:Rails", (), "the module own.lacking cannot be imported: ModuleNotFoundError: No module named 'nosuchmodule'"),
        ("own.leaving:Rails", (), "the module own.leaving cannot be imported: SystemExit: 0"),
    ],
)
def test_what_is_wrong_with_a_name_is_told(rails, tmp_path, name, more, message):
    (tmp_path / "own" / "wrong.py").write_text("def\n")
    (tmp_path / "own" / "lacking.py").write_text("import nosuchmodule\n")
    (tmp_path / "own" / "leaving.py").write_text("raise SystemExit(0)\n")
    done = rails("--simulator", name, *more, "-o", "runs.jsonl")
    assert done.code == 2
    assert message in done.err
    assert "internal error" not in done.err
    assert not (tmp_path / "runs.jsonl").exists()


def test_its_classes_are_told_where_another_was_named(rails):
    assert "its simulators are Rails, Fixed, Broken" in rails("--simulator", "own.rails:Trains").err


@pytest.mark.slow
def test_several_processes_make_it_as_well(rails, tmp_path):
    for workers, name in ((1, "a.jsonl"), (2, "b.jsonl")):
        assert rails("--simulator", "own.rails:Rails", "-n", 5, "--workers", workers, "-o", name).code == 0
    assert (tmp_path / "a.jsonl").read_bytes() == (tmp_path / "b.jsonl").read_bytes()


@pytest.mark.slow
def test_the_command_finds_it_in_the_current_folder_and_the_program_does_not(rails, tmp_path):
    """Also where Python itself does not look there (`-P`)."""
    (tmp_path / "q.scenic").write_text("import own.rails\n" + PROGRAM)
    command = [sys.executable, "-P", "-m", "scenic_ref", "simulate", "--simulator", "own.rails:Rails", "--steps", "1"]
    done = subprocess.run([*command, "p.scenic"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    refused = subprocess.run([*command, "q.scenic"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert refused.returncode == 1
    assert "--trust" in refused.stderr


def test_trace_runs_it_too(rails, ask):
    traced = [ask("trace", "p.scenic", "--steps", 9, "--simulator", "own.rails:Rails", "--attempt", 1, "-p", f"east={east}") for east in (-1, 1)]
    assert [done.code for done in traced] == [0, 0]
    assert "discarded, with its scene: this fails in time step 0: the simulator rejected the run: no place to spawn" in traced[0].out
    assert "accepted: ended by the simulator: episode done" in traced[1].out
