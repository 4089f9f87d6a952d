"""Scenarios in Pyro: the moves of `sites` as a kernel of its `MCMC`, and any static scenario as a model. To import this needs Pyro.

The model draws with Pyro's own distributions, where it has them, and runs the machine as it is: a second implementation of every draw.
"""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pyro
import pyro.distributions as dist
import torch
from pyro.infer.mcmc.mcmc_kernel import MCMCKernel

from ..data.scene import Scene, scene_of
from ..interpreter.runtime.program_run import Accepted, generate_scene
from ..interpreter.runtime.random_streams import fold
from ..semantics.machine.config import Config
from ..semantics.machine.outcome import Draw
from ..semantics.space.distributions import Coin, Normal, Range
from ..semantics.store.errors import UsageError
from .batch import Batch
from .moves.proposals import NAMES
from .moves.states import States
from .moves.target import Target
from .smc import move, moves_of, run_splitting

LARGEST_NUMBER = 1.0 - 2.0**-53
STARTS = 64
"""States that splitting finds, in one of which a chain begins."""


class SceneKernel(MCMCKernel):
    """The moves of `sites.moves` as a kernel: a step is `passes` moves of each block, on average.

    Its parameters are the random numbers of a run: "numbers", and "words" of the draws that take no fixed number of them. Chains of
    `pyro.infer.MCMC` differ by the seeds that it gives them. Raises what `smc.run_splitting` raises.
    """

    def __init__(self, batch: Batch, seed: int = 0, *, passes: int = 2) -> None:
        self.target = Target(batch, seed)
        self.moves = moves_of(self.target)
        self.seed, self.passes = seed, passes
        self.transforms: dict[str, object] = {}
        self.is_warm = False
        self.state: States | None = None
        self.taken: dict[str, list[float]] = {}

    def setup(self, warmup_steps: int, *arguments: object, **keywords: object) -> None:
        """Find a state to begin with."""
        own = int(torch.randint(0, 2**53, ()).item())  # Pyro gives each chain another seed
        self.random = np.random.Generator(np.random.Philox(np.random.SeedSequence([fold(self.seed), own])))
        self.is_warm = warmup_steps == 0
        if self.state is None:
            populations, self.moves = run_splitting(self.target, 1, STARTS, self.random)
            found = populations[0].states
            self.state = found.at(self.random.integers(STARTS, size=1))

    @property
    def initial_params(self) -> dict[str, torch.Tensor]:
        """The state to begin with."""
        assert self.state is not None
        return self.as_tensors(self.state)

    @initial_params.setter
    def initial_params(self, params: Mapping[str, torch.Tensor]) -> None:
        self.state = states_of(self.target, {name: value[None] for name, value in params.items()})

    def as_tensors(self, state: States) -> dict[str, torch.Tensor]:
        """One state as parameters; words are floats, which hold them exactly."""
        found: dict[str, torch.Tensor] = {}
        if self.target.space.sites:
            found["numbers"] = torch.from_numpy(state.uniforms[:, 0].copy())
        if self.target.space.drawn:
            found["words"] = torch.from_numpy(state.words[:, 0].astype(float))
        return found

    def sample(self, params: Mapping[str, torch.Tensor]) -> dict[str, torch.Tensor]:
        """Return the next state."""
        zero = np.zeros(1)
        state, _, taken = move(
            self.target, self.moves, states_of(self.target, {n: v[None] for n, v in params.items()}), zero, zero, self.passes, self.random
        )
        if not self.is_warm:
            self.moves.adapt(taken)
        for name, part in taken.parts().items():
            self.taken.setdefault(name, []).append(part)
        return self.as_tensors(state)

    def end_warmup(self) -> None:
        """From now on steps stay as large as they are."""
        self.is_warm, self.taken = True, {}

    def logging(self) -> OrderedDict[str, str]:  # type: ignore[override]
        """The part of each kind of move that was taken."""
        return OrderedDict((name, f"{np.mean(self.taken[name]):.2f}") for name in NAMES if name in self.taken)

    def diagnostics(self) -> dict[str, object]:
        """Return the shares of moves that were taken, for Pyro's report."""
        return {"taken": {name: float(np.mean(parts)) for name, parts in self.taken.items()}}

    def scenes(self, samples: Mapping[str, torch.Tensor]) -> list[Scene]:
        """The scenes of what `MCMC.get_samples()` gives, without the groups by chain."""
        return list(self.target.scenes(states_of(self.target, samples), self.seed))


def states_of(target: Target, params: Mapping[str, torch.Tensor]) -> States:
    """Parameters, (draws, numbers) each, as states."""
    space, draws = target.space, max(map(len, params.values()), default=1)
    numbers = params["numbers"].detach().numpy().T if space.sites else np.zeros((0, draws))
    words = np.zeros((len(space.drawn) + 1, draws), dtype=np.uint64)
    if space.drawn:
        words[:] = params["words"].numpy().T.astype(np.uint64)
    return States(np.clip(numbers, 0.0, LARGEST_NUMBER), words)


class NumberModel:
    """A scenario as a model of Pyro in the random numbers of its runs: "numbers", all uniform, and a factor that is 0 for an accepted run, else
    minus infinity.

    Whatever a draw's distribution depends on, the density is smooth where runs are accepted, so that `NUTS` and `HMC` can be used: well where
    all runs are accepted, badly else, since they cannot see the edge. Raises `UsageError` for programs with draws that take no fixed number
    of random numbers.
    """

    def __init__(self, batch: Batch, seed: int = 0) -> None:
        self.target, self.seed = Target(batch, seed), seed
        if self.target.space.drawn:
            raise UsageError("a draw of this program takes no fixed number of random numbers: it has no model in these", hint="use `pyro_kernel`")

    def __call__(self) -> torch.Tensor:
        """Draw the numbers of a run, and weigh it."""
        uniform: Any = dist.Uniform(double_tensor(0.0), double_tensor(1.0))
        numbers = pyro.sample("numbers", uniform.expand([len(self.target.space.sites)]).to_event(1))
        accepted = self.target.assess(states_of(self.target, {"numbers": numbers[None]})).violation[0] == 0
        pyro.factor("requirements", double_tensor(0.0 if accepted else -math.inf))
        return numbers

    def scenes(self, samples: Mapping[str, torch.Tensor]) -> list[Scene]:
        """The scenes of what `MCMC.get_samples()` gives, without the groups by chain."""
        return list(self.target.scenes(states_of(self.target, samples), self.seed))


def model_of(start: Callable[[], Config], fuel: int) -> Callable[[], Scene | None]:
    """A scenario as a model of Pyro: a sample statement for each draw, and a factor that is 0 for an accepted run, minus infinity for others.

    It returns the scene, None for a run that is rejected. Draws of a distribution without a counterpart in Pyro, such as points of regions, are
    made of uniform numbers, each a sample statement.
    """

    def model() -> Scene | None:
        ended = generate_scene(start(), sample_with_pyro, fuel=fuel)
        accepted = isinstance(ended, Accepted)
        pyro.factor("requirements", double_tensor(0.0 if accepted else -math.inf))
        return scene_of(ended.state, 0, 0, 1) if isinstance(ended, Accepted) else None

    return model


def sample_with_pyro(draw: Draw) -> object:
    """The value of a draw, from sample statements that are named by its address."""
    if draw.per_scene:
        raise UsageError("with the reading soft=scene, coins are thrown before the scenes are drawn: a model draws given the requirements")
    name, found = ".".join(map(str, draw.address)), draw.distribution
    match found:
        case Range(low=low, high=high) if low < high:
            return statement(name, dist.Uniform(double_tensor(low), double_tensor(high)))
        case Normal(mean=mean, stdDev=deviation) if deviation > 0:
            return statement(name, dist.Normal(double_tensor(mean), double_tensor(deviation)))
        case Coin(probability=probability):
            return bool(statement(name, dist.Bernoulli(double_tensor(float(probability)))))
    support = found.support()
    if support is not None:
        place = statement(name, dist.Categorical(torch.tensor([float(share) for _, share in support], dtype=torch.float64)))
        return support[int(place)][0]
    used = 0

    def uniform() -> float:
        nonlocal used
        used += 1
        return statement(f"{name}.{used - 1}", dist.Uniform(double_tensor(0.0), double_tensor(1.0)))

    return found.sample(uniform)


def statement(name: str, distribution: Any) -> float:
    """A sample statement, as a number."""
    return float(pyro.sample(f"draw {name}", distribution))


def double_tensor(value: float) -> torch.Tensor:
    """A number as a tensor of double precision."""
    return torch.tensor(value, dtype=torch.float64)
