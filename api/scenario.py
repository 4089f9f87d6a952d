"""A scenario: a program with its readings, dialect, modules and parameters, ready to be sampled (DESIGN, section 7)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from copy import copy
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from ..data.recording_reader import Recording
from ..data.scene import OWN_FIELDS, Scene, json_value, scene_of
from ..data.simulation import Simulated
from ..inference.batch import Batch, Block, Impossible, NotLifted
from ..inference.batch.evaluation_plan import only_rejects
from ..inference.batch.features import features_in, supports_of
from ..inference.batch.jobs.worker_pools import block_of, jobs
from ..inference.batch.suggested_features import Suggested
from ..inference.batch.torch_devices import check_device
from ..inference.comparison.known_features import Facts
from ..inference.comparison.scene_columns import FeatureTable, features_table, leaves
from ..inference.enumeration import DEFAULT_RUNS, Enumeration, Histories, enumerate_runs, enumerate_simulations
from ..inference.importance import draw_importance
from ..inference.mcmc import draw_mcmc
from ..inference.moves.target import Target
from ..inference.pruning import TECHNIQUES, Finding, Pruning, prune
from ..inference.rejection import DEFAULT_ATTEMPTS, Sampled, no_scene_error, sample
from ..inference.result import Inferred
from ..inference.simulation_rejection import NextScene, SampledRun, sample_simulation
from ..inference.smc import draw_smc
from ..interpreter.language.checks import check_runnable
from ..interpreter.language.dialects import DIALECTS
from ..interpreter.language.modules import library_of, module_named, with_old_imports
from ..interpreter.runtime.answerers import AS_THEY_ARE, Draws, from_stream
from ..interpreter.runtime.optional_packages import missing_package_error
from ..interpreter.runtime.program_run import DEFAULT_FUEL, Accepted, Run, Witness, generate_scene, rehearse
from ..pictures.notebook_views import line_of_program, page_of_program
from ..pictures.scene_figures import draw_scenes, multiples_layout
from ..semantics.machine.config import Config, Settings, State
from ..semantics.machine.outcome import Done, GivenValues, Outcome
from ..semantics.machine.values import unwrap
from ..semantics.programs import definitions, initial, make_settings
from ..semantics.readings import select
from ..semantics.store.errors import AttemptsExhausted, InternalError, NoEgo, UsageError
from ..semantics.store.scopes import descendants
from ..semantics.syntax import Node, Program, Span
from ..semantics.syntax.python_expressions import Call, Comparison, Name
from ..semantics.syntax.statements import Require
from ..simulators import by_name
from ..simulators.behaviors.compiled_library import Library
from ..simulators.loop import Failed, Settled
from ..simulators.protocol import Simulator
from ..simulators.worlds import modules_of
from ..simulators.worlds.names import MODELS_BY_NAME
from .argument_checks import check_settings, check_whole, no_backend
from .conditioning import conditioned_scenario
from .engine_choice import Backend
from .pickling import Condition, reduce_scenario
from .scene_iterator import Drawn, ToldScenes, progress_of, sample_scenes
from .simulations import (
    SimulationBackend,
    SimulationRange,
    Told,
    check_simulation_backend,
    replay_recording,
    simulate_many,
)

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.figure import Figure

    from ..inference.batch.torch_margins import Margins
    from ..inference.pyro_adapter import NumberModel, SceneKernel


class ForPyro(NamedTuple):
    """The classes and functions of `inference.pyro_adapter`, which needs Pyro."""

    kernel: type[SceneKernel]
    numbers: type[NumberModel]
    model: Callable[[Callable[[], Config], int], Callable[[], Scene | None]]


def pyro_for(what: str) -> ForPyro:
    """Return the Pyro adapters that `what` needs. Raises `UsageError` without the extra `pyro`."""
    try:
        from ..inference.pyro_adapter import NumberModel, SceneKernel, model_of
    except ImportError as problem:
        raise missing_package_error(what, "pyro", problem) from None
    return ForPyro(SceneKernel, NumberModel, model_of)


MOST = 100
"""Scenes in one picture."""


def scenario_line(scenario: Scenario) -> str:
    """The scenario in one line, with the readings that are not those of its dialect."""
    usual = select(DIALECTS[scenario.program.dialect].profile)
    readings = {name: alternative for name, alternative in scenario.readings.items() if usual[name] != alternative}
    program = scenario.program
    return line_of_program(program.file, program.dialect, readings, scenario.params, given=scenario.conditioned_from is not None)


def plot_scenes(scenario: Scenario, n: int, seed: int) -> Figure:
    """Draw the first scenes into one figure; see `Scenario.plot`."""
    import matplotlib.pyplot as plt

    if n > MOST:
        raise UsageError(f"a picture holds {MOST} scenes at most, not {n:,}")
    scenes = list(scenario.sample_many(n, seed))
    rows, columns, side = multiples_layout(n)
    figure = plt.figure(figsize=(columns * side, rows * (side + 0.3)), layout="constrained")
    draw_scenes(figure, scenes, None)
    return figure


SCALE, NOISY = "mutationScale", {"position", "heading", "color"}
"""The property that says whether an object is mutated, and those that mutation changes (rule T-Mutate, reading `mutate-color`)."""


def constants_of(start: Callable[[], Config], *, max_attempts: int = DEFAULT_ATTEMPTS, fuel: int) -> dict[str, object]:
    """The features of the scene format that do not depend on any draw, with their values.

    Which values are random does not depend on what is drawn (reading `random-branch`), so that one accepted run is enough.
    Raises `AttemptsExhausted` if none is found.
    """
    ends: list[State] = []

    def keep(outcome: Outcome, drawn: object) -> None:
        if isinstance(outcome, Done):
            ends.append(outcome.state)

    sample(start, 0, 0, max_attempts=max_attempts, fuel=fuel, witnessed=lambda attempt: keep)
    state = ends[-1]
    scene = scene_of(state, 0, 0, 1).to_json()
    params = {name: json_value(value) for name, value in state.params.items() if unwrap(value)[1] is None}
    objects = scene["objects"]
    assert isinstance(objects, list)
    kept = [_constant_part(o, state, i) for i, o in enumerate(objects)]
    return dict(leaves({"ego": scene["ego"], "params": params, "objects": kept}))


def facts_of(constants: dict[str, object], batch: Batch | None, pruned: Draws) -> Facts:
    """Return what is known of the scenes before any is drawn: constants, and with a graph the supports that it shows and the features that it
    suggests.

    Where runs that the graph does not describe are left to the interpreter, there are no supports.
    """
    if batch is None:
        return Facts(constants)
    sure = all(map(only_rejects, batch.graph.events))
    suggested = Suggested(batch.graph, batch.template, pruned, sure=sure)
    supports = {name: support for name, support in supports_of(batch.template).items() if name not in constants} if sure else {}
    return Facts(constants, {**supports, **suggested.supports}, suggested)


def _constant_part(written: dict[str, object], state: State, number: int) -> dict[str, object]:
    """An object in the scene format, without the properties that depend on a draw."""
    held = state.objects[state.scene[number].number]
    fixed = {name for name, value in held.items() if unwrap(value)[1] is None}
    if SCALE in held and SCALE not in fixed:  # whether there is noise may depend on a draw, and there was none in this run
        fixed -= NOISY
    properties = written["properties"]
    assert isinstance(properties, dict)
    own = {name: written[name] for name in OWN_FIELDS if name in fixed}
    return {"class": written["class"], **own, "properties": {name: v for name, v in properties.items() if name in fixed}}


def calls(node: Node) -> bool:
    """Return whether a node calls a function, which may compare other values, but for `abs`."""
    return isinstance(node, Call) and not (isinstance(node.function, Name) and node.function.name == "abs")


class Scenario:
    """A loaded program.

    `profile` and `readings` choose among the readings of the paper; without a profile, that of the program's dialect counts.
    `params` are global parameters that win over the program's own; `model` is the world model that replaces the program's (or is
    added, if it names none). `scenario` is the modular scenario to begin with, else `Main` if there is one, else the program itself. Modules
    and maps are looked for in `directory`.
    """

    def __init__(
        self, program: Program, *, profile: str | None = None, readings: Mapping[str, str] | None = None, params: Mapping[str, object] | None = None,
        model: str | None = None, trust: bool = False, directory: str | Path | None = None, fuel: int = DEFAULT_FUEL, scenario: str | None = None,
    ) -> None:
        check_settings(readings, params, fuel, directory)
        self.program = program
        self.profile = profile
        self.readings = select(DIALECTS[program.dialect].profile if profile is None else profile, readings)
        self.params = dict(params or {})
        self.model = model
        self.trust = trust
        self.directory = None if directory is None else Path(directory)
        self.fuel = fuel
        self.scenario = scenario
        self.draws: Draws = AS_THEY_ARE
        self.factorised = False
        self.device: str | None = None
        self.given = GivenValues()
        self.conditioned_from: Scenario | None = None
        self.condition: Condition | None = None
        self._rehearsed = False
        check_runnable(program)

    @cached_property
    def settings(self) -> Settings:
        """The settings that all runs of this scenario share."""
        library = library_of(
            self.program, worlds=modules_of(self.program, self.params, self.directory), model=self.model, trust=self.trust, directory=self.directory,
            dialect=self.program.dialect if self.program.dialect != "paper" else None,
        )
        world = None if self.model is None else module_named(self.model, library)
        if isinstance(world, Exception):
            raise UsageError(f"the world model: {world}", hint=getattr(world, "hint", "") or "; ".join(getattr(world, "__notes__", ())))
        return make_settings(
            self.readings, library, self.params, self.model, self.scenario, trusted=self.trust, given=self.given, elsewhere=MODELS_BY_NAME,  # type: ignore[arg-type]
            defined=definitions(self.program), dialect=self.program.dialect,
        )  # fmt: skip

    def start(self) -> Config:
        """The configuration that every run begins with."""
        return initial(with_old_imports(self.program, self.settings.library), self.settings)  # type: ignore[arg-type]

    def rehearse(self, witness: Witness | None = None) -> None:
        """Run the program once, to find a branch on a random value. Raises the program's error; a `witness` sees the run, if it was not yet."""
        if not self._rehearsed:
            rehearse(self.start(), from_stream(0, 0, 0), fuel=self.fuel, witness=witness)
            self._rehearsed = True

    @cached_property
    def constants(self) -> dict[str, object]:
        """The features of a scene that are the same whatever is drawn, by their place in the scene format. Raises `AttemptsExhausted`."""
        self.rehearse()
        return constants_of(self.start, fuel=self.fuel)

    @cached_property
    def facts(self) -> Facts:
        """Facts that hold for every scene, whatever is drawn; comparisons use them. Raises
        `AttemptsExhausted`.
        """
        return facts_of(self.constants, self.batch, self.pruning.draws)

    def sample(self, seed: int = 0, index: int = 0, *, max_attempts: int = DEFAULT_ATTEMPTS) -> Scene:
        """Scene number `index` of `seed`."""
        check_whole(("seed", seed, None), ("index", index, 0), ("max_attempts", max_attempts, 1))
        return self.sampled(seed, index, max_attempts=max_attempts).scene

    def sampled(
        self, seed: int = 0, index: int = 0, *, max_attempts: int = DEFAULT_ATTEMPTS, on_attempt: Callable[[int], None] | None = None,
        witnessed: Callable[[int], Witness] | None = None,
    ) -> Sampled:  # fmt: skip
        """The scene with the statistics of its attempts. `on_attempt` and `witnessed` are those of `inference.rejection.sample`.

        Where parts are drawn apart, the graph finds the attempts, which `on_attempt` is not told of; only the last run is witnessed, and its
        steps are those that are given.
        """
        self.rehearse()
        if not self.in_parts:
            return sample(
                self.start, seed, index, max_attempts=max_attempts, fuel=self.fuel, on_attempt=on_attempt, witnessed=witnessed, draws=self.draws,
            )
        block = self._alone(seed, index, max_attempts)
        attempts = int(block.attempts[0])
        ended = self.last_run(seed, index, attempts + 1, block, witness=None if witnessed is None else witnessed(attempts))
        if not isinstance(ended, Accepted):
            raise InternalError(f"the parts of scene {index} of seed {seed} make no scene: {ended.requirement.text}")
        return Sampled(scene_of(ended.state, seed, index, attempts + 1, pruned=True), block.stuck, ended.steps)

    def last_run(self, seed: int, index: int, attempts: int, block: Block | None = None, *, witness: Witness | None = None) -> Run:
        """Only the last attempt at a scene that is known to need `attempts`; `block` is a drawing of it by the batch backend, if there is one."""
        attempt: int | Callable[[tuple[int, ...]], int] = attempts - 1
        if self.in_parts:
            batch = self.batch
            assert batch is not None
            attempt = batch.attempts_of(block or self._alone(seed, index, attempts), index)
        return generate_scene(self.start(), from_stream(seed, index, attempt, self.draws), fuel=self.fuel, witness=witness)

    def last_state(self, witness: Witness) -> State:
        """The state at the end of an accepted run, which `witness` has seen. Raises `AttemptsExhausted`."""
        self.rehearse()
        attempts = self.sampled().scene.attempts
        ended = self.last_run(0, 0, attempts, witness=witness)
        assert isinstance(ended, Accepted)
        return ended.state

    def _alone(self, seed: int, index: int, max_attempts: int) -> Block:
        """A scene by the batch backend. Raises its error."""
        batch = self.batch
        assert batch is not None
        block = block_of(batch, seed, index, index + 1, max_attempts)
        if block.error is not None:
            raise block.error
        return block

    @property
    def in_parts(self) -> bool:
        """Whether rejection is factorised and there is more than one component, so that parts of a scene are drawn apart."""
        return self.factorised and self.batch is not None and bool(self.batch.stage.parts)

    @cached_property
    def pruning(self) -> Pruning:
        """Which points may be drawn from smaller regions, and why others may not (paper, Section "Domain-Specific Sampling Techniques")."""
        self.rehearse()
        try:
            return prune(self.start, self.fuel)
        except (NotLifted, NoEgo) as reason:
            why = reason.message if isinstance(reason, NoEgo) else str(reason)
            return Pruning((), tuple(Finding("all objects", technique, None, None, why) for technique in TECHNIQUES))

    def pruned(self) -> Scenario:
        """Return this scenario with pruning and factorised rejection. Each seed gives other scenes, from the
        same distribution, with less work.
        """
        found = copy(self)
        found.__dict__.pop("_lifted", None)
        found.draws, found.factorised = self.pruning.draws, True
        return found

    def condition_on(
        self, scene: Scene | None = None, *, objects: Iterable[int] | None = None, params: Mapping[str, object] | None = None
    ) -> Scenario:
        """Return this scenario conditioned on the `objects` of `scene` (by default all of them) and on values
        of global parameters.

        Every draw on which these objects depend has the value that it had there; a parameter that is itself a
        draw has the given value, and of any other it is required. The rest keeps its distribution, and all
        requirements have to hold (docs/api.md). Raises `UsageError`, also where it is known that no scene is
        so (else sampling raises `AttemptsExhausted`), and the errors that the program has given all this.
        """
        return conditioned_scenario(self, scene, objects, params or {})

    def on_device(self, device: str) -> Scenario:
        """Return this scenario with its graph evaluated by torch on a device, "cpu" or "cuda"; its scenes
        agree up to 1e-9 (docs/batch.md).

        Raises `UsageError` without the extra `torch`, and for a device that it cannot use.
        """
        check_device(device)
        found = copy(self)
        found.__dict__.pop("_lifted", None)
        found.device = device
        return found

    def enumerate(
        self, *, max_runs: int = DEFAULT_RUNS, discretize: int | None = None, on_run: Callable[[int, Fraction], None] | None = None
    ) -> Enumeration:
        """The exact distribution of the scenes; see `enumerate_runs`."""
        self.rehearse()
        return enumerate_runs(self.start, max_runs=max_runs, discretize=discretize, fuel=self.fuel, on_run=on_run)

    @cached_property
    def _lifted(self) -> Batch | AttemptsExhausted | NoEgo | str:
        """The program as a graph, or why there is none; the error if it can have no scene."""
        self.rehearse()
        try:
            batch = Batch(self.start, fuel=self.fuel, draws=self.draws, factorised=self.factorised)
            if self.device is not None:
                batch.use_tensors(self.device)
            return batch
        except Impossible as never:
            text = f"no scene is possible: {never.requirement.failure}, whatever is drawn"
            error = no_scene_error(text, 1, Counter([never.requirement]))
            operator, _, sides = never.decision.partition(": ")
            if operator and operator == self._compared(never.requirement.span):
                error.hint = "; ".join(filter(None, (sides, error.hint)))
            return error
        except NotLifted as reason:
            return str(reason)
        except NoEgo as none:
            return none

    def _compared(self, span: Span) -> str:
        """The operator where the statement at a place requires one comparison of what calls no functions, which was then decided last, else ""."""
        nodes = (node for statement in self.program.statements for node in descendants(statement) if node.span == span)
        required = next((node.condition for node in nodes if isinstance(node, Require)), None)
        operators = required.operators if isinstance(required, Comparison) and not any(map(calls, descendants(required))) else ()
        return operators[0] if len(operators) == 1 else ""

    @property
    def share(self) -> float:
        """The probability that a run is one of those from the smaller regions of `pruned`, as all accepted ones are."""
        return self.pruning.share if self.draws else 1.0

    @property
    def impossible(self) -> AttemptsExhausted | None:
        """The error if a requirement fails whatever is drawn, as far as bounds of the values show that."""
        return self._lifted if isinstance(self._lifted, AttemptsExhausted) else None

    @property
    def batch(self) -> Batch | None:
        """The program as a graph that draws many scenes at a time; None if it cannot be made one. Raises the program's error."""
        return self._lifted if isinstance(self._lifted, Batch) else None

    @property
    def not_lifted(self) -> str | None:
        """Why the program cannot be made a graph, so that the interpreter draws its scenes; None if it can."""
        if isinstance(self._lifted, (AttemptsExhausted, NoEgo)):
            return self._lifted.message
        return self._lifted if isinstance(self._lifted, str) else None

    def sample_many(
        self, n: int, seed: int = 0, *, start: int = 0, max_attempts: int = DEFAULT_ATTEMPTS, backend: Backend = "auto",
        progress: bool | ToldScenes = False,
    ) -> Drawn:  # fmt: skip
        """Scenes `start` to `start + n - 1` of `seed`, one after the other or as columns: the same ones whatever the backend.

        "batch" draws many at a time if the program can be made a graph (else `not_lifted` says why); "auto" does so for
        more than a few scenes, and says at once that none is possible, if bounds show it (`AttemptsExhausted`).
        `progress` shows a bar, or is called with the number of scenes so far. Raises `UsageError` for other backends.
        """
        check_whole(("n", n, 0), ("seed", seed, None), ("start", start, 0), ("max_attempts", max_attempts, 1))
        return sample_scenes(self, n, seed, start, max_attempts, backend, progress_of(progress, n))

    def sample_columns(self, n: int, seed: int = 0, *, max_attempts: int = DEFAULT_ATTEMPTS) -> dict[str, np.ndarray]:
        """The objects of `n` scenes as NumPy arrays, one object in each row: `sample_many(n, seed).columns()`."""
        return self.sample_many(n, seed, max_attempts=max_attempts).columns()

    def infer(
        self, backend: str, n: int, seed: int = 0, *, resample: bool = False, max_attempts: int = DEFAULT_ATTEMPTS,
        on_progress: Callable[[str], None] | None = None,
    ) -> Inferred:  # fmt: skip
        """`n` scenes by "importance", "smc" or "mcmc", with an estimate of how likely the requirements are, and what the scenes are worth.

        Points are drawn from the smaller regions of `pruning`. `resample` gives scenes of weight 1 by importance sampling, and
        `max_attempts` bounds its runs for each scene. Raises `UsageError` for other backends, for programs that cannot be made a graph, and
        with the reading `soft=scene`; `AttemptsExhausted` where no scene is found; and the program's errors.
        """
        check_whole(("n", n, 1), ("seed", seed, None), ("max_attempts", max_attempts, 1))
        if backend not in ("importance", "smc", "mcmc"):
            raise no_backend(backend, ("importance", "smc", "mcmc"), elsewhere=("auto", "interpreter", "batch"), there="`sample_many`")
        batch = self._pruned_batch(backend)
        share = self.pruning.share
        tell = on_progress or (lambda text: None)
        match backend:
            case "importance":
                return draw_importance(
                    batch, n, seed, share=share, resample=resample, max_attempts=max_attempts, on_scenes=lambda found: tell(f"{found:,} scenes"),
                )
            case "smc":
                return draw_smc(batch, n, seed, share=share, on_level=lambda part, level: tell(f"{part:.0%} accepted, violation {level:.3g}"))
            case _:
                return draw_mcmc(batch, n, seed, share=share, on_draw=lambda part: tell(f"{part:.0%}"))

    def margins(self, seed: int = 0, device: str = "cpu") -> Margins:
        """By how much the requirements are met, with gradients by random numbers and poses. Raises as `infer` and `on_device` do."""
        check_device(device)
        if self.batch is None:
            raise self.impossible or UsageError(f"there are no margins of this program: {self.not_lifted}")
        from ..inference.batch.torch_margins import Margins

        return Margins(Target(self.batch, seed), device)

    def pyro_kernel(self, seed: int = 0) -> SceneKernel:
        """The moves of `infer("mcmc")` as a kernel of `pyro.infer.MCMC`. Raises as `infer` does, and `UsageError` without the extra `pyro`."""
        return pyro_for("`pyro_kernel`").kernel(self._pruned_batch("Pyro's MCMC", "`pyro_model` can be used all the same"), seed)

    def pyro_numbers(self, seed: int = 0) -> NumberModel:
        """The scenario as a model of Pyro in the random numbers of its runs, for `NUTS`: see `inference.pyro_adapter.NumberModel`. Raises the same.
        """
        return pyro_for("`pyro_numbers`").numbers(self._pruned_batch("Pyro's MCMC", "`pyro_model` can be used all the same"), seed)

    def pyro_model(self) -> Callable[[], Scene | None]:
        """The scenario as a model of Pyro: see `inference.pyro_adapter.model_of`. Raises `UsageError` without the extra `pyro`."""
        self.rehearse()
        return pyro_for("`pyro_model`").model(self.start, self.fuel)

    def _pruned_batch(self, backend: str, otherwise: str = "the interpreter can: --backend interpreter") -> Batch:
        """The graph, in which points are drawn from the smaller regions of `pruning`. Raises `AttemptsExhausted`, `UsageError`."""
        if isinstance(self._lifted, (AttemptsExhausted, NoEgo)):
            raise self._lifted
        if self.batch is None:
            raise UsageError(f"{backend} cannot draw from this program: {self.not_lifted}", hint=otherwise)
        return Batch(self.start, fuel=self.fuel, draws=self.pruning.draws)

    def feature_tables(
        self, n: int, seed: int = 0, *, start: int = 0, max_attempts: int = DEFAULT_ATTEMPTS
    ) -> Iterator[FeatureTable]:  # fmt: skip
        """The features of scenes `start` to `start + n - 1` of `seed`, as columns of some scenes after the other; for comparisons."""
        if self.impossible is not None:
            raise self.impossible
        if self.batch is None:
            yield features_table(self.sample(seed, index, max_attempts=max_attempts) for index in range(start, start + n))
            return
        for block in jobs(self.batch, n, seed, start, max_attempts):
            yield features_in(self.batch.template, block)

    def simulate(
        self, simulator: str | Simulator = "still", steps: int = 100, seed: int = 0, index: int = 0, *, timestep: float | None = None,
        max_attempts: int = DEFAULT_ATTEMPTS, on_attempt: Callable[[int], None] | None = None,
        on_failed: Callable[[Failed], None] | None = None, witnessed: Callable[[int], Witness | None] | None = None,
        backend: SimulationBackend = "compiled", settled: Settled | None = None,
    ) -> SampledRun:  # fmt: skip
        """Simulation number `index` of `seed`, of at most `steps` time steps; rejected runs are discarded as a whole (reading `rejected-simulation`).

        `simulator` is one of `simulators.SIMULATORS` by name, or "package.module:Class" (`timestep`, in seconds, is then that of the simulation),
        or a simulator itself. The `backend` "compiled" runs behaviors as Python code, where that can be, "interpreter" by the machine; the
        simulations are the same.

        `settled` is shown each time step (a `Moment`: poses, actions, events) when it has passed; a text that it gives ends the simulation in the
        next one, with the result "settled" and the text as its reason, if nothing else ends it. Requirements over time are judged as they stand
        then.
        """
        check_simulation_backend(backend)
        check_whole(("steps", steps, 0), ("seed", seed, None), ("index", index, 0), ("max_attempts", max_attempts, 1))
        self.rehearse()
        found = by_name(simulator, timestep) if isinstance(simulator, str) else simulator
        return sample_simulation(
            self.start, found, steps, seed, index, max_attempts=max_attempts, fuel=self.fuel,
            retry=self.readings["rejected-simulation"] == "retry", on_attempt=on_attempt, on_failed=on_failed, witnessed=witnessed,
            library=self.compiled if backend == "compiled" else None,
            next_scene=lambda first: self.next_scene(seed, index, first, max_attempts), settled=settled,
        )  # fmt: skip

    def next_scene(self, seed: int, index: int, first: int, max_attempts: int) -> NextScene | None:
        """Return the first attempt from number `first` on that gives scene `index`, by the batch backend; None if it cannot draw from the program.

        Raises the program's errors, and `AttemptsExhausted` if it is known that no scene is possible.
        """
        if self.impossible is not None:
            raise self.impossible
        if self.batch is None or self.in_parts:
            return None
        block = self.batch.block(seed, index, index + 1, max_attempts=max_attempts, first=first)
        if block.error is None:
            return NextScene(int(block.attempts[0]), block.stuck)
        if isinstance(block.error, AttemptsExhausted):
            return NextScene(max_attempts, block.stuck)
        raise block.error

    @cached_property
    def compiled(self) -> Library:
        """The library of compiled behaviors, monitors and functions; it grows while simulations run."""
        return Library(self.readings)

    def simulate_many(
        self, n: int, *, simulator: str | Simulator = "still", steps: int = 100, seed: int = 0, start: int = 0, timestep: float | None = None,
        max_attempts: int = DEFAULT_ATTEMPTS, workers: int = 1, progress: Told | None = None, backend: SimulationBackend = "compiled",
    ) -> Iterator[SampledRun]:  # fmt: skip
        """Simulations `start` to `start + n - 1` of `seed`, in order: those of `simulate`, and of `scenic-ref simulate -n`, whoever runs them.

        `workers` processes run them (a script needs `if __name__ == "__main__":` then), each with a simulator of its own, which is given by its
        name. `progress(simulations, attempts)` is told how many there are so far. Errors are raised where one process would raise them.
        """
        check_whole(("n", n, 0), ("steps", steps, 0), ("seed", seed, None), ("start", start, 0))
        check_whole(("max_attempts", max_attempts, 1), ("workers", workers, 1))
        check_simulation_backend(backend)
        self.rehearse()
        which = SimulationRange(start, start + n, seed, steps, timestep, max_attempts, backend)
        return simulate_many(self, which, simulator, workers, progress)

    def replay(
        self, record: Mapping[str, object] | Recording, simulator: str | Simulator = "still", *, timestep: float | None = None
    ) -> Simulated:
        """A simulation whose actions are those of `record`, a line of the simulation format as JSON; its time step is the recorded one by default.

        Raises `UsageError` if the record is not one of this program, or if its actions cannot be taken, `AttemptsExhausted` if it is rejected.
        """
        self.rehearse()
        return replay_recording(self, record, simulator, timestep)

    def enumerate_simulations(
        self, simulator: str | Simulator = "still", steps: int = 10, *, timestep: float | None = None, max_runs: int = DEFAULT_RUNS
    ) -> Histories:  # fmt: skip
        """The exact distribution of simulations of at most `steps` time steps; see `inference.enumeration.enumerate_simulations`."""
        check_whole(("steps", steps, 0), ("max_runs", max_runs, 1))
        self.rehearse()
        found = by_name(simulator, timestep) if isinstance(simulator, str) else simulator
        return enumerate_simulations(self.start, found, steps, max_runs=max_runs, fuel=self.fuel)

    def __repr__(self) -> str:
        return scenario_line(self)

    def _repr_html_(self) -> str:
        """The text of the program, for notebooks: nothing is drawn, which could take long."""
        return page_of_program(scenario_line(self), self.program.text)

    def plot(self, n: int = 9, seed: int = 0) -> Figure:
        """A new figure of `matplotlib.pyplot` with the first `n` scenes of `seed` (100 at most), seen from above in metres.

        Raises `UsageError` for other numbers and for coordinates that cannot be drawn, `AttemptsExhausted`, and the program's errors.
        """
        check_whole(("n", n, 1), ("seed", seed, None))
        return plot_scenes(self, n, seed)

    def __copy__(self) -> Scenario:
        """Another scenario of the same program, which shares what was computed."""
        found = object.__new__(type(self))
        found.__dict__.update(self.__dict__)
        return found

    def __reduce__(self) -> tuple[Callable[..., Scenario], tuple[object, ...]]:
        """For `pickle`: text, settings, and what was given. Raises `UsageError` for what cannot be pickled."""
        return reduce_scenario(self)

