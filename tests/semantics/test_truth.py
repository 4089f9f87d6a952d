"""What a condition may be under reading `condition-truth = any`, as in the profiles of the releases."""

from __future__ import annotations

import pytest
import scenic_ref
from scenic_ref.semantics.store.errors import RunError

BEFORE = "import math\nclass K(object): pass\ndef f(): return False\nbehavior B():\n    wait\nscenario S():\n    setup: pass\n"
BEHAVIOR = "behavior C():\n{}\nego = Object with behavior C()\n"
FORMS = {
    "require": "ego = Object\nrequire {}\n",
    "soft": "ego = Object\nrequire[0.5] {}\n",
    "always": "ego = Object\nrequire always {}\n",
    "eventually": "ego = Object\nrequire eventually {}\n",
    "terminate": "ego = Object\nterminate when {}\n",
    "interrupt": BEHAVIOR.format("    try:\n        wait\n    interrupt when {}:\n        wait"),
    "until": BEHAVIOR.format("    do B() until {}"),
    "precondition": BEHAVIOR.format("    precondition: {}\n    wait"),
    "invariant": BEHAVIOR.format("    invariant: {}\n    wait"),
    "in a behavior": BEHAVIOR.format("    require {}\n    wait"),
}
KINDS = {
    "B()": "the behavior B()", "B": "the behavior B", "S()": "the scenario S()", "Object": "the class Object", "K": "the class K",
    "f": "a function", "lambda: True": "a function", "math": "a module", "Range": "a distribution", "print": "a built-in function",
    "ego.canSee": "a method",
}  # fmt: skip


def told(form: str, condition: str) -> str:
    """What is said of a program with this condition: "" if it runs."""
    try:
        scenario = scenic_ref.loads(BEFORE + FORMS[form].format(condition), dialect="scenic-2.1", profile="scenic-2.1")
        if form in ("require", "soft"):
            scenario.sample()
        else:
            scenario.simulate(steps=1, backend="interpreter")
    except RunError as error:
        return error.message
    return ""


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("condition", ["B()", "Object"])
def test_a_definition_is_no_condition_anywhere(form: str, condition: str) -> None:
    assert told(form, condition).endswith(f"must be a boolean, not {KINDS[condition]}")


@pytest.mark.parametrize("condition", KINDS)
def test_a_definition_of_any_kind_is_no_condition(condition: str) -> None:
    assert told("require", condition) == f"a requirement must be a boolean, not {KINDS[condition]}"


@pytest.mark.parametrize("condition", ["3", "'a'", "([1])", "ego", "everywhere", "K()", "ego.position", "1 == 1"])
def test_other_values_are_as_true_as_in_python(condition: str) -> None:
    assert told("require", condition) == ""
