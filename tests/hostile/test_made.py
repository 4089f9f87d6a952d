"""What only the machine makes: a program finds the class of such a value by `type`, if at all, and cannot call it."""

from __future__ import annotations

import gc
from enum import Enum
from importlib import import_module

import pytest
import scenic_ref
from scenic_ref.roads.immutable import Fixed
from scenic_ref.semantics.machine import sandbox_table
from scenic_ref.semantics.python.builtins import BUILTINS
from scenic_ref.semantics.store import errors
from scenic_ref.semantics.store.containers import Counter, OrderedDict, deque

SQUARE = "r = PolygonalRegion([(0, 0), (1, 0), (1, 1), (0, 1)])\nc = CircularRegion((0, 0), 1)\nego = new Object\ndef f(*a): return a[0]\nxs = [1]\n"
METHOD = "type(everywhere.intersect)"


@pytest.mark.parametrize("expression", [
    "type(DistanceFrom)('f', f)", "type(DistanceFrom)('f', f)(1, 2)", "type(ego.distanceTo)(1, 'f', f)(3)", "type(DistanceFrom)('f', list)([1])",
    f"{METHOD}(f, 1)", f"{METHOD}(list.append, xs)(1)", f"{METHOD}(f, {METHOD}(f, 1))", f"list(map({METHOD}, [f], [1]))", f"{METHOD}(bytes, 10 ** 9)()",
    "type(r.polygon)('x').contains('x')", "type(r.polygon)(type(r.polygon)(r.polygon))", "type(r.polygon)(r).intersects(r)",
    "list(map(type(r.polygon), ['x']))", "sorted([1, 2], key=type(r.polygon))", "min([1, 2], key=type(r.polygon))",
    "type(c.intersect(r))(c, [1])", "type(c.union(r))(1, 2)", "type(c.difference(r))('a', c)", "type(everywhere)()", "type(nowhere)()",
])  # fmt: skip
def test_a_program_cannot_make_what_the_machine_makes(expression):
    with pytest.raises(errors.ProgramError, match=r"cannot call \w+, the class|is not a class of this language") as caught:
        scenic_ref.loads(f"# dialect: scenic-3\n{SQUARE}x = {expression}\n").sample()
    assert caught.value.span.line == 7


def test_every_class_that_type_may_give_is_one_that_a_program_has_by_name_or_cannot_call():
    for module in ("roads.network_builder", "simulators.actions", "interpreter.language.modules"):
        import_module(f"scenic_ref.{module}")
    named = {v for v in BUILTINS.values() if isinstance(v, type)} | {Counter, OrderedDict, deque}
    found = {c for c in gc.get_objects() if issubclass(type(c), type) and str(c.__module__).startswith("scenic_ref.") and sandbox_table.is_known(c)}
    others = {c for c in found - named if sandbox_table.may_make(c) and not sandbox_table.is_user_class(c) and not issubclass(c, (Fixed, Enum, Exception))}
    strangers = {c.__name__ for c in others if not c.__module__.startswith("scenic_ref.simulators.")}
    assert strangers <= {"Seeded"}  # random.Random
    assert len(found) > 30
