"""Pyro drives our moves, and its own draws and inference give our laws."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

import numpy as np
import pytest
import scenic_ref
from scenic_ref.data.scene import Scene
from scenic_ref.inference.comparison.exact_laws import Categorical, Continuous, contradicts
from scenic_ref.inference.enumeration import content_of_scene
from scenic_ref.semantics.store.errors import UsageError

pytestmark = pytest.mark.extra("pyro")
LARGER = "x, y = Range(0, 1), Range(0, 1)\nego = Object at x @ y\nrequire x > y\n"
LAW = Continuous("x", lambda x: x * x if x < 1 else 1.0, 0.0, 1.0)
CHOICES = """
x = Uniform(1, 2, 3)
y = Discrete({'a': 1, 'b': 3})
ego = Object at x @ 0
require[0.5] x > 1
require x < 3 or y == 'a'
param y = y
"""
MIXED = """
ego = Object at Normal(0, 2) @ TruncatedNormal(0, 1, -1, 3), facing Range(0, 90) deg
Object in CircularRegion(20 @ 20, 3), with requireVisible False
require ego.position.x > 1
"""
CURVE = """
road = PolylineRegion([0@0, 10@5, 20@0], orientation=None)
ego = Object at 0 @ Range(-1, 0), with viewDistance 12
p = Point on visible road
Object at p.position
"""


def drawn_by(model: Callable[[], Scene | None], count: int) -> list[Scene]:
    """The scenes of some runs of a model."""
    from pyro import poutine

    found = [poutine.trace(model).get_trace().nodes["_RETURN"]["value"] for _ in range(count)]
    return [scene for scene in found if scene is not None]


def test_pyros_chain_of_our_moves_has_our_law() -> None:
    import pyro
    from pyro.infer import MCMC

    pyro.set_rng_seed(1)
    kernel = scenic_ref.loads(LARGER).pyro_kernel(seed=1)
    mcmc = MCMC(kernel, num_samples=1_200, warmup_steps=100, disable_progbar=True)
    mcmc.run()
    scenes = kernel.scenes(mcmc.get_samples())
    assert len(scenes) == 1_200
    assert all(scene.objects[0].position.x > scene.objects[0].position.y for scene in scenes)
    assert not contradicts([scene.objects[0].position.x for scene in scenes[::6]], LAW)
    assert set(mcmc.diagnostics()) >= {"taken"}
    assert 0 < mcmc.diagnostics()["taken"]["chain 0"]["step"] <= 1
    assert mcmc.diagnostics()["numbers"]["n_eff"].min() > 100


def test_words_are_parameters_too() -> None:
    from pyro.infer import MCMC

    kernel = scenic_ref.loads(CURVE).pyro_kernel(seed=2)
    mcmc = MCMC(kernel, num_samples=40, warmup_steps=5, disable_progbar=True)
    mcmc.run()
    assert set(mcmc.get_samples()) == {"numbers", "words"}
    scenes = kernel.scenes(mcmc.get_samples())
    assert len({scene.objects[1].position for scene in scenes}) > 5
    kernel.initial_params = {name: value[0] for name, value in mcmc.get_samples().items()}
    assert content_of_scene(kernel.scenes({n: v[None] for n, v in kernel.initial_params.items()})[0]) == content_of_scene(scenes[0])


def test_the_model_has_a_statement_for_each_draw_and_the_law_of_the_program() -> None:
    import pyro
    from pyro import poutine

    pyro.set_rng_seed(3)
    scenario = scenic_ref.loads(CHOICES)
    model = scenario.pyro_model()
    trace = poutine.trace(model).get_trace()
    assert len([name for name in trace.nodes if name.startswith("draw ")]) == 3
    assert "requirements" in trace.nodes
    scenes = drawn_by(model, 900)
    exact = scenario.enumerate()
    assert not contradicts([content_of_scene(scene) for scene in scenes], Categorical(exact.law(content_of_scene)))
    assert abs(len(scenes) / 900 - exact.acceptance) < 0.1


@pytest.mark.slow
def test_pyros_importance_sampling_counts_the_requirements() -> None:
    import pyro
    from pyro.infer import Importance

    pyro.set_rng_seed(4)
    scenario = scenic_ref.loads(CHOICES)
    found = Importance(scenario.pyro_model(), num_samples=1_500).run()
    accepted = [weight > -1e9 for weight in found.log_weights]
    exact = float(scenario.enumerate().acceptance)
    assert not contradicts([bool(a) for a in accepted], Categorical({True: exact, False: 1 - exact}))


def test_continuous_draws_are_pyros_own() -> None:
    import pyro
    from pyro import poutine

    pyro.set_rng_seed(5)
    scenario = scenic_ref.loads(MIXED)
    model = scenario.pyro_model()
    nodes = poutine.trace(model).get_trace().nodes
    kinds = Counter(type(node["fn"]).__name__ for name, node in nodes.items() if name.startswith("draw "))
    assert kinds["Normal"] == 1
    assert kinds["Uniform"] >= 4
    drawn = [scene.objects[0].position.y for scene in drawn_by(model, 600)]
    ours = [scene.objects[0].position.y for scene in scenario.sample_many(200, seed=1)]
    assert abs(sum(drawn) / len(drawn) - sum(ours) / len(ours)) < 0.35


SMOOTH = "x = Range(1, 2)\ny = Range(0, x)\nego = Object at x @ y, facing Normal(0, 0.1)\n"


@pytest.mark.slow
def test_nuts_draws_from_a_program_in_which_all_runs_are_accepted() -> None:
    """Level: about 1e-6 each (4.9 standard deviations of as many independent draws as Pyro says)."""
    import pyro
    from pyro.infer import MCMC, NUTS

    pyro.set_rng_seed(5)
    model = scenic_ref.loads(SMOOTH).pyro_numbers()
    chain = MCMC(NUTS(model, max_tree_depth=5), num_samples=300, warmup_steps=100, disable_progbar=True)
    chain.run()
    assert not chain.diagnostics()["divergences"]["chain 0"]
    worth = float(chain.diagnostics()["numbers"]["n_eff"].min())
    assert worth > 100
    places = [scene.objects[0].position for scene in model.scenes(chain.get_samples())]
    assert abs(np.mean([p.x for p in places]) - 1.5) < 4.9 * np.sqrt(1 / 12 / worth)
    assert abs(np.mean([p.y / p.x for p in places]) - 0.5) < 4.9 * np.sqrt(1 / 12 / worth)


@pytest.mark.slow
def test_nuts_keeps_to_a_requirement_but_most_of_its_paths_end_at_the_edge() -> None:
    """It cannot see the edge."""
    import pyro
    from pyro.infer import MCMC, NUTS

    pyro.set_rng_seed(5)
    model = scenic_ref.loads(LARGER).pyro_numbers()
    chain = MCMC(NUTS(model, max_tree_depth=4), num_samples=150, warmup_steps=50, disable_progbar=True)
    chain.run()
    assert all(scene.objects[0].position.x > scene.objects[0].position.y for scene in model.scenes(chain.get_samples()))
    assert len(chain.diagnostics()["divergences"]["chain 0"]) > 30


def test_a_draw_without_a_fixed_number_of_numbers_has_no_model_in_them() -> None:
    with pytest.raises(UsageError, match="no fixed number"):
        scenic_ref.loads(CURVE).pyro_numbers()
