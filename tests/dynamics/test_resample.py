"""`resample` while a scenario runs: an independent sample from the distribution that a variable was drawn from."""

from __future__ import annotations

from fractions import Fraction

import pytest
import scenic_ref
from scenic_ref.semantics.store.errors import RunError
from scenic_ref.simulators.loop import Simulated

from .worlds import behavior, simulated

BEFORE = """
top = Uniform(1, 2, 3)
def drawn(low=1):
    return Uniform(low, 2, 3)
def again(x):
    return resample(x)
behavior Sub(x):
    take resample(x), x
"""
PAIRS = {
    "a variable": "y = Uniform(1, 2, 3)\ntake resample(y), y",
    "a copy of it": "y = Uniform(1, 2, 3)\nz = y\ntake resample(z), y",
    "a variable of the program": "take resample(top), top",
    "the distribution itself": "y = Uniform(1, 2, 3)\ntake resample(Uniform(1, 2, 3)), y",
    "what a function returns": "y = drawn()\ntake resample(y), y",
    "a parameter of a function": "y = Uniform(1, 2, 3)\ntake again(y), y",
    "a parameter of a behavior": "do Sub(Uniform(1, 2, 3))",
    "what was resampled": "y = Uniform(1, 2, 3)\nz = resample(y)\ntake resample(z), y",
}


@pytest.mark.parametrize("body", PAIRS.values(), ids=PAIRS)
def test_the_sample_is_independent_and_has_the_same_distribution(body):
    law = scenic_ref.loads(behavior(body, BEFORE)).enumerate_simulations(steps=1).law(lambda run: run.moments[0].actions[0])
    assert law == {(a, b): Fraction(1, 9) for a in (1, 2, 3) for b in (1, 2, 3)}


def test_parameters_of_the_distribution_are_not_drawn_again():
    """Section "Data Types": "conditioned on the values of the distribution's parameters"."""
    body = "low = Uniform(0, 10)\ny = Range(low, low + 1)\ntake resample(y), y"
    for seed in range(20):
        run = simulated(behavior(body), 1, seed=seed)
        assert isinstance(run, Simulated)
        again, first = run.moments[0].actions[0]
        assert again != first
        assert (again < 5) == (first < 5)


def test_variables_that_know_their_distribution_decide_control_flow_all_the_same():
    body = "y = Uniform(1, 2)\nn = 0\nwhile n < y and y > 0:\n    n += 1\n    take n\nxs = [y]\nxs.append(y)\nxs.sort()\nif y in xs:\n    take 'in'"
    law = scenic_ref.loads(behavior(body)).enumerate_simulations(steps=4).law(
        lambda run: tuple(a for moment in run.moments for a in moment.actions.get(0, ()))
    )
    assert law == {(1, "in"): Fraction(1, 2), (1, 2, "in"): Fraction(1, 2)}


@pytest.mark.parametrize("what", ["xs[0]", "self.x", "y + 1", "3"])
def test_what_no_longer_knows_its_distribution_is_an_error(what):
    text = behavior(f"y = Uniform(1, 2)\nxs = [Uniform(1, 2)]\nself.x = Uniform(1, 2)\ntake resample({what})")
    with pytest.raises(RunError, match="resample needs a variable that a value was drawn into"):
        simulated(text, 1)
