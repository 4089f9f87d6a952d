"""The matcher `simulations` and errors of simulations, against implementations that are wrong on purpose; what the vectors about them cover."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

import pytest
from scenic_ref.conformance import ConformanceVector, Enumerated, NeverAccepted, Ourselves, Refused, Task, judge, load_vectors
from scenic_ref.conformance.implementations.protocol import SceneRecord, SimulationRecord
from scenic_ref.conformance.matchers.simulations import AlwaysRejected, Simulations
from scenic_ref.conformance.vector_files import read_file
from scenic_ref.semantics.readings import READINGS
from scenic_ref.semantics.rules import RULES
from scenic_ref.semantics.store.errors import UsageError

VECTORS = [v for v in load_vectors() if v.steps is not None]
HEAD = 'chapter = "C"\n[[vector]]\nname = "v"\npaper = "p"\nprogram = "ego = Object"\n'
ONE = "simulations = { steps = 4, actions = [1, [], [2, 'b']], result = 'terminated', objects = [1, 1, 2, 2] }"
TWO = """
[vector.simulations]
steps = 1
histories = [
    { probability = "1/4", actions = [1], result = "time limit" },
    { probability = "3/4", actions = [{ 0 = [2], 1 = [3] }], result = "time limit" },
]
rival = ["1/2", "1/2"]
acceptance = "1/2"
samples = 400
"""
NEVER = "simulations = { steps = 2, rejected = ['always', 'guard'] }"
FAILS = "error = { phase = 'run', line = 3, steps = 2 }"


def vector(more: str) -> ConformanceVector:
    (found,) = read_file("f.toml", HEAD + more)
    return found


def record(*actions: dict[str, list[object]], result: str = "terminated", objects: tuple[int, ...] = ()) -> SimulationRecord:
    """A simulation; after its last time step nothing is done."""
    counts = objects or (1,) * (len(actions) + 1)
    taken: list[dict[str, list[object]]] = [*actions, {}]
    return {"result": result, "steps": [{"step": k, "actions": a, "objects": [{}] * n} for k, (a, n) in enumerate(zip(taken, counts))]}


class NoSimulator:
    """Scenes only."""

    name = "static"
    dialects: tuple[str, ...] = ("paper",)

    def follows(self, reading: str, alternative: str) -> bool:
        return True

    def scenes(self, task: Task, count: int, *, seed: int, attempts: int) -> Iterator[SceneRecord]:
        yield from Ourselves().scenes(task, count, seed=seed, attempts=attempts)


class Plays(NoSimulator):
    """The same simulations in turn, whatever the program is; or an error."""

    name = "player"

    def __init__(self, *played: SimulationRecord | Exception, missing: int = 0) -> None:
        self.played = played
        self.missing = missing

    def simulations(self, task: Task, steps: int, count: int, *, seed: int, attempts: int) -> Iterator[SimulationRecord]:
        for index in range(count - self.missing):
            one = self.played[index % len(self.played)]
            if isinstance(one, Exception):
                raise one
            yield one


class Enumerates(Plays):
    """A law, whatever the program is."""

    def __init__(self, found: Enumerated | None, *played: SimulationRecord) -> None:
        super().__init__(*played)
        self.found = found

    def enumerated_simulations(self, task: Task, steps: int) -> Enumerated | None:
        return self.found


class Traces(Plays):
    """The same rules in every simulation."""

    def fired_in_simulations(self, task: Task, steps: int, wanted: frozenset[str], *, seed: int) -> frozenset[str]:
        return frozenset({"D-Take"})


class Samples(NoSimulator):
    """Ourselves without enumeration and traces."""

    def simulations(self, task: Task, steps: int, count: int, *, seed: int, attempts: int) -> Iterator[SimulationRecord]:
        yield from Ourselves().simulations(task, steps, count, seed=seed, attempts=attempts)


RIGHT = record({"0": [1]}, {}, {"0": [2, "b"]}, objects=(1, 1, 2, 2))
LOW, HIGH = record({"0": [1]}, result="time limit"), record({"0": [2], "1": [3]}, result="time limit")


def law(low: str, high: str, acceptance: str = "1/2") -> Enumerated:
    return Enumerated(((Fraction(low), LOW), (Fraction(high), HIGH)), Fraction(acceptance))


CASES: dict[str, tuple[NoSimulator, str, str, str]] = {
    # one history
    "the right one": (Plays(RIGHT), ONE, "passed", ""),
    "empty lists of actions": (Plays(record({"0": [1], "1": []}, {"0": []}, {"0": [2, "b"]}, objects=(1, 1, 2, 2))), ONE, "passed", ""),
    "another action": (Plays(record({"0": [1]}, {}, {"0": [2, "c"]})), ONE, "failed", "in time step 2 the actions are {'0': [2, 'c']}, not"),
    "the actions in another order": (Plays(record({"0": [1]}, {}, {"0": ["b", 2]})), ONE, "failed", "in time step 2"),
    "another agent": (Plays(record({"1": [1]}, {}, {"0": [2, "b"]})), ONE, "failed", "in time step 0 the actions are {'1': [1]}, not {'0': [1]}"),
    "an action where there is none": (Plays(record({"0": [1]}, {"0": [1]}, {"0": [2, "b"]})), ONE, "failed", "in time step 1"),
    "true for 1": (Plays(record({"0": [True]}, {}, {"0": [2, "b"]})), ONE, "failed", "in time step 0"),
    "a time step too few": (Plays(record({"0": [1]}, {})), ONE, "failed", "2 time steps pass, and it ends with 'terminated', not 3 and"),
    "a time step too many": (Plays(record({"0": [1]}, {}, {"0": [2, "b"]}, {})), ONE, "failed", "4 time steps pass"),
    "another end": (
        Plays(record({"0": [1]}, {}, {"0": [2, "b"]}, result="time limit")), ONE, "failed", "ends with 'time limit', not 3 and 'terminated'",
    ),
    "actions after the end": (
        Plays({"result": "terminated", "steps": [*RIGHT["steps"][:3], {"actions": {"0": [1]}, "objects": []}]}),  # type: ignore[index]
        ONE, "failed", "there are actions after the last time step",
    ),
    "another number of objects": (Plays(record({"0": [1]}, {}, {"0": [2, "b"]})), ONE, "failed", "there are [1, 1, 1, 1] objects"),
    "no time steps": (Plays({"result": "terminated"}), ONE, "failed", "the simulation has no steps"),
    "not always the same": (Plays(RIGHT, LOW), ONE, "failed", "1 time steps pass"),
    "a simulation too few": (Plays(RIGHT, missing=1), ONE, "failed", "gave 2 simulations, and 3 were asked for"),
    "an error": (Plays(Refused("run", "no")), ONE, "failed", "refused in phase run: no"),
    "a rejection": (Plays(NeverAccepted(frozenset({"always"}))), ONE, "failed", "no run was accepted: these failed: always"),
    "a crash": (Plays(RuntimeError("out of memory")), ONE, "errored", "RuntimeError: out of memory"),
    "no simulator": (NoSimulator(), ONE, "skipped", "static does not simulate"),
    "rules that do not fire": (Traces(RIGHT), ONE + "\nfires = ['D-Wait']", "failed", "these rules did not fire: D-Wait"),
    "rules that must not fire": (Traces(RIGHT), ONE + "\navoids = ['D-Take']", "failed", "these rules fired and must not: D-Take"),
    "rules that nobody watches": (Plays(RIGHT), ONE + "\navoids = ['D-Take']", "passed", ""),
    # several histories
    "the right frequencies": (Plays(LOW, HIGH, HIGH, HIGH), TWO, "passed", ""),
    "other frequencies": (Plays(LOW, HIGH), TWO, "failed", "the samples of simulations contradict the law"),
    "always the same history": (Plays(HIGH), TWO, "failed", "contradict the law"),
    "frequencies in between": (Plays(*[LOW] * 3, *[HIGH] * 5), TWO, "failed", "do not contradict the rival"),
    "no history": (Plays(LOW, RIGHT), TWO, "failed", "a simulation is not one of the histories: its actions are [{'0': [1]}, {}, {'0': [2, 'b']}]"),
    "the right law": (Enumerates(law("1/4", "3/4")), TWO, "passed", ""),
    "another law": (Enumerates(law("1/2", "1/2")), TWO, "failed", "histories[0] has probability 1/2, not 1/4"),
    "another acceptance": (Enumerates(law("1/4", "3/4", "1")), TWO, "failed", "a run is accepted with probability 1, not 1/2"),
    "a history missing": (Enumerates(Enumerated(((Fraction(1), HIGH),), Fraction(1, 2))), TWO, "failed", "histories[0] has probability 0"),
    "enumeration gives up": (Enumerates(None, LOW, HIGH, HIGH, HIGH), TWO, "passed", ""),
    # no history
    "the right rejection": (Plays(NeverAccepted(frozenset({"always", "guard"}))), NEVER, "passed", ""),
    "a rejection without its reason": (Plays(NeverAccepted()), NEVER, "passed", ""),
    "a rejection for another reason": (
        Plays(NeverAccepted(frozenset({"always"}))), NEVER, "failed", "never accepted, but not because of always, guard alone: these failed: always",
    ),
    "an error instead of a rejection": (Plays(Refused("run", "no")), NEVER, "failed", "refused in phase run instead of never accepted: no"),
    "everything accepted": (Plays(RIGHT), NEVER, "failed", "gave 1 simulations, and no run may be accepted (always, guard)"),
    "no simulator to reject": (NoSimulator(), NEVER, "skipped", "does not simulate"),
    # errors
    "the right error": (Plays(Refused("run", "no", line=3)), FAILS, "passed", ""),
    "an error in another line": (Plays(Refused("run", "no", line=2)), FAILS, "failed", "refused with line 2, not 3"),
    "an error of another phase": (Plays(Refused("parse", "no")), FAILS, "failed", "refused in phase parse, not run"),
    "no error": (Plays(RIGHT), FAILS, "failed", "gave 1 simulations instead of an error of phase run"),
    "a rejection instead of an error": (Plays(NeverAccepted()), FAILS, "failed", "never accepted instead of refused in phase run"),
    "no simulator for an error": (NoSimulator(), FAILS, "skipped", "does not simulate"),
}  # fmt: skip


@pytest.mark.parametrize("what", CASES)
def test_the_verdict_and_its_reason(what: str) -> None:
    implementation, text, status, reason = CASES[what]
    head, _, more = text.partition("\nfires") if "\nfires" in text else text.partition("\navoids")
    key = "fires" if "\nfires" in text else "avoids"
    verdict = judge(implementation, vector(f"{key}{more}\n{head}" if more else text)).verdict
    assert verdict.status == status, verdict.reason
    assert reason in verdict.reason


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (ONE.replace("steps = 4, ", ""), "the key steps is missing"),
        (ONE.replace("steps = 4", "steps = 0"), "steps must be a whole number above 0"),
        (ONE.replace("steps = 4", "steps = 2"), "has those of at most 2 time steps, and these are 3"),
        (ONE.replace("terminated", "time limit"), "has those of 4 time steps, and these are 3"),
        (ONE.replace("'terminated'", "'over'"), "result must be 'terminated' or 'time limit', not 'over'"),
        (ONE.replace("result = 'terminated', ", ""), "the key result is missing"),
        (ONE.replace("[1, [], [2, 'b']]", "3"), "actions must be a list, not 3"),
        (ONE.replace("[1, [], [2, 'b']]", "[1, { ego = [1] }, 2]"), "lists by the object's number"),
        (ONE.replace("[1, [], [2, 'b']]", "[1, { 0 = 1 }, 2]"), "lists by the object's number"),
        (ONE.replace("[1, [], [2, 'b']]", "[1, { 0 = [] }, 2]"), "lists by the object's number"),
        (ONE.replace("[1, 1, 2, 2]", "[1, 1, 2]"), "objects must be a number for each of 4 times"),
        (ONE.replace("[1, 1, 2, 2]", "[1, 1, 2, true]"), "objects must be a number for each of 4 times"),
        (ONE.replace("steps = 4", "steps = 4, mood = 1"), "there is no key mood"),
        (ONE.replace("steps = 4", "steps = 4, samples = 9"), "there is no key samples"),
        (TWO.replace('"1/4"', '"1/2"'), "the probabilities of histories must be one for each history and add up to 1"),
        (TWO.replace('rival = ["1/2", "1/2"]', 'rival = ["1"]'), "the probabilities of rival must be one for each history"),
        (TWO.replace('rival = ["1/2", "1/2"]\n', ""), "the key rival is missing"),
        (TWO.replace("samples = 400\n", ""), "the key samples is missing"),
        (TWO.replace('probability = "1/4", ', ""), "histories[0]: the key probability is missing"),
        (TWO.replace("actions = [1],", "actions = [1], mood = 2,"), "there is no key mood"),
        (NEVER.replace("'guard'", "'mood'"), "there is no requirement 'mood'"),
        (NEVER.replace("['always', 'guard']", "[]"), "rejected must name one kind of requirement or more"),
        (NEVER.replace("steps = 2", "steps = 2, actions = [1]"), "there is no key actions"),
        (FAILS.replace("steps = 2", "steps = 0"), "steps must be a whole number above 0"),
        ("simulations = 3", "a table is expected, not 3"),
    ],
)
def test_a_fault_of_a_table_is_named(text: str, message: str) -> None:
    with pytest.raises(UsageError) as caught:
        vector(text)
    assert message in caught.value.message


def test_a_single_history_is_written_without_histories() -> None:
    second = '    { probability = "3/4", actions = [{ 0 = [2], 1 = [3] }], result = "time limit" },\n'
    with pytest.raises(UsageError, match="a single history is written without `histories`"):
        vector(TWO.replace(second, "").replace('"1/4"', '"1"').replace('["1/2", "1/2"]', '["1"]'))


# What the vectors cover, each of them holding by test_vectors.py


SAMPLED = [v for v in VECTORS if isinstance(v.matcher, Simulations) and len(v.matcher.histories) > 1]


@pytest.mark.slow
@pytest.mark.parametrize("vector", SAMPLED, ids=lambda v: v.name)
def test_the_vector_holds_by_sampling_and_tells_its_rival(vector: ConformanceVector) -> None:
    verdict = judge(Samples(), vector).verdict
    assert (verdict.status, verdict.reason) == ("passed", "")


@pytest.mark.parametrize("rule", [rule for rule in RULES if rule.startswith("D-")])
def test_every_rule_of_the_dynamic_constructs_fires_in_a_vector_and_must_not_in_another(rule: str) -> None:
    assert [v.name for v in VECTORS if rule in v.fires]
    assert [v.name for v in VECTORS if rule in v.avoids]


def test_every_alternative_of_every_reading_about_the_policy_has_a_vector() -> None:
    wanted = {(r.id, alternative) for r in READINGS.values() if r.about == "policy" for alternative in r.alternatives}
    assert wanted <= {pair for v in load_vectors() for pair in v.readings.items()}


@pytest.mark.sampled(8)
@pytest.mark.parametrize("name", [r.id for r in READINGS.values() if r.about == "policy" and len(r.alternatives) > 1])
def test_the_alternatives_of_a_reading_are_told_apart(name: str) -> None:
    def swapped(task: Task) -> Task:
        other = next(a for a in READINGS[name].alternatives if a != task.readings[name])
        return Task(task.program, task.dialect, {**task.readings, name: other})

    class Other(Ourselves):
        def simulations(self, task, steps, count, *, seed, attempts):
            return super().simulations(swapped(task), steps, count, seed=seed, attempts=min(attempts, 100))

        def enumerated_simulations(self, task, steps):
            return super().enumerated_simulations(swapped(task), steps)

    verdicts = [judge(Other(), v).verdict.status for v in VECTORS if name in v.readings]
    assert verdicts.count("failed") >= 2


@pytest.mark.parametrize("kind", ["always", "eventually", "guard", "precondition", "require", "collision"])
def test_every_kind_of_requirement_rejects_the_simulations_of_a_vector(kind: str) -> None:
    assert [v for v in VECTORS if isinstance(v.matcher, AlwaysRejected) and kind in v.matcher.kinds]
