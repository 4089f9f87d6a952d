"""What a small change of the rules would break where many scenes are drawn at a time. Found by `make mutants`."""

from __future__ import annotations

import signal

import pytest
import scenic_ref
from scenic_ref.semantics.store.errors import RunError

LIFTED = {
    "a vector along a field, in the runs that have one": """
        field = PolygonalVectorField('field', [(PolygonalRegion([0@0, 10@0, 10@10, 0@10]), 30 deg)])
        require Uniform(True, False) or (20@20 offset along field by 1@2).x > 3
        ego = Object at Range(0, 1) @ 3
        """,
    "a drawn oriented point": """
        point = Uniform(OrientedPoint at 1@2, OrientedPoint at 3@2, facing 10 deg)
        ego = Object at 0@0, with seen (point can see 0@1)
        """,
}


@pytest.mark.parametrize("name", LIFTED)
def test_many_scenes_are_drawn_at_a_time_of(name: str) -> None:
    program = "\n".join(line.strip() for line in LIFTED[name].splitlines())
    scenario = scenic_ref.loads(program)
    drawn = list(scenario.sample_many(20, seed=1, backend="batch"))
    assert scenario.not_lifted is None
    assert drawn == list(scenario.sample_many(20, seed=1, backend="interpreter"))


@pytest.mark.parametrize("backend", ["batch", "interpreter"])
def test_a_drawn_key_that_is_a_list_in_some_runs_is_an_error(backend: str) -> None:
    scenario = scenic_ref.loads("x = Discrete({Uniform(1, [2]): 1, 3: 2})\nego = Object at 0@0, with tag 3")
    with pytest.raises(RunError, match="unhashable type: 'list'"):
        list(scenario.sample_many(20, seed=0, backend=backend))


@pytest.mark.extra("fast")
def test_an_interrupt_waits_until_the_compiler_is_done() -> None:
    """What is raised where the compiler's library calls Python would be ignored there; afterwards it is heard."""
    from scenic_ref.inference.batch.numba_evaluator import later_interrupts

    done = []
    with pytest.raises(KeyboardInterrupt):
        with later_interrupts():
            signal.raise_signal(signal.SIGINT)
            done.append("compiled")
        done.append("not reached")
    assert done == ["compiled"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    with pytest.raises(KeyboardInterrupt), later_interrupts():
        signal.raise_signal(signal.SIGINT)
        raise ValueError("what the compiler cannot do")


@pytest.mark.parametrize(
    "text",
    [
        "x = Uniform(1, 'a')\nrequire not isinstance(x, str)\nparam p = x\n",
        "x = Range(0, 1)\nparam p = isinstance(x, float), q = isinstance(x, int)\n",
        "x = Uniform(1, 2.5, True)\nparam p = isinstance(x, int), q = isinstance(x, bool), r = isinstance(x, (str, float))\n",
        "x = Uniform([1], (2, 3))\nparam p = isinstance(x, list)\n", "x = Uniform(Range(0, 1), 'a')\nparam p = isinstance(x, str)\n",
        "class A:\n    foo: 1\na = A at 9 @ 9\nx = Uniform(ego, a)\nparam p = isinstance(x, A), q = isinstance(x, Object)\n",
        "x = Uniform(CircularRegion(0 @ 0, 2), RectangularRegion(0 @ 0, 0, 1, 1))\nrequire isinstance(x, CircularRegion)\nparam p = str(x)\n",
        "x = Uniform(1, 2) + Uniform(1, 2)\nparam p = isinstance(x, int)\n", "x = 1\nparam p = isinstance(x, Uniform(int, str))\n",
        "x = Uniform(1, None)\nrequire isinstance(x, type(None))\nparam p = x\n",
    ],
)  # fmt: skip
def test_the_class_of_what_is_drawn_is_that_of_each_value(text: str) -> None:
    scenario = scenic_ref.loads("ego = Object\n" + text)
    drawn = [[s.to_json() for s in scenario.sample_many(40, 1, backend=backend)] for backend in ("batch", "interpreter")]  # type: ignore[arg-type]
    assert drawn[0] == drawn[1]
