"""The texts of a vector in other dialects are the same program as the paper's: the same tree, once it is clear what makes an object."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace

import pytest
from scenic_ref.conformance import ConformanceVector, load_vectors
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.semantics.syntax import Node
from scenic_ref.semantics.syntax.expressions import InInitialScenario, ObjectDefinition, ObjectOrOperator, ObjectOrValue
from scenic_ref.semantics.syntax.python_expressions import Name
from scenic_ref.semantics.syntax.statements import ClassDefinition

BUILT_IN = {"Point", "OrientedPoint", "Object"}
OF_WORLDS = {"Car", "Rover", "Goal", "Rock", "BigRock", "Pipe"}


def settled(tree: object, classes: set[str]) -> object:
    """The tree in which everything that a class name begins is an object definition, as `new` makes plain in scenic-3."""
    match tree:
        case ObjectOrOperator(head=Name(name=name), as_object=made) if name in classes:
            return settled(made, classes)
        case ObjectOrOperator(as_operator=operator):
            return settled(operator, classes)
        case ObjectOrValue(value=Name(name=name) as head) if name in classes:
            return ObjectDefinition(class_=head)
        case ObjectOrValue(value=value):
            return settled(value, classes)
        case tuple():
            return tuple(settled(item, classes) for item in tree)
        case _ if is_dataclass(tree) and isinstance(tree, Node):
            return replace(tree, **{f.name: settled(getattr(tree, f.name), classes) for f in fields(tree) if f.name != "span"})
        case _:
            return tree


def nodes(tree: object) -> Iterator[Node]:
    if isinstance(tree, tuple):
        for item in tree:
            yield from nodes(item)
    elif isinstance(tree, Node):
        yield tree
        for f in fields(tree):  # pyright: ignore[reportArgumentType]
            yield from nodes(getattr(tree, f.name))


def classes_of(tree: object) -> set[str]:
    return BUILT_IN | OF_WORLDS | {node.name for node in nodes(tree) if isinstance(node, ClassDefinition)}


def tree_of(text: str, dialect: str) -> object:
    if "viewDistance" not in text:  # the releases' spelling
        text = text.replace("visibleDistance", "viewDistance")
    tree = parse(text.replace("simulation().", "simulation."), dialect=dialect).statements
    return settled(tree, classes_of(tree) if dialect != "scenic-3" else set())


def is_parsed(vector: ConformanceVector) -> bool:
    return not (vector.kind == "error" and getattr(vector.matcher, "phases", ()) == ("parse",))


SEVERAL = [v for v in load_vectors() if "paper" in v.texts and len(v.texts) > 1 and is_parsed(v)]


@pytest.mark.parametrize("vector", SEVERAL, ids=lambda v: v.name)
def test_the_program_is_the_same_tree_in_every_dialect(vector: ConformanceVector) -> None:
    trees = {dialect: tree_of(text, dialect) for dialect, text in vector.texts.items()}
    assert all(tree == trees["paper"] for tree in trees.values())


def test_most_vectors_are_given_in_the_released_dialects() -> None:
    """Some cannot be said there: `|` and `<<`, several behaviors at a time or overrides in behaviors in Scenic 2.1."""
    vectors = [v for v in load_vectors() if is_parsed(v)]
    for dialect in ("scenic-2.1", "scenic-3"):
        assert sum(dialect in v.texts for v in vectors) > 0.9 * len(vectors)


def test_another_program_is_told_apart() -> None:
    assert tree_of("ego = Object at (0, 0)\n", "paper") == tree_of("ego = new Object at (0, 0)\n", "scenic-3")
    assert tree_of("ego = Object at (0, 0)\n", "paper") != tree_of("ego = new Object at (0, 1)\n", "scenic-3")
    assert tree_of("ego = Object\n", "paper") != tree_of("ego = Object\n", "scenic-3")
    assert InInitialScenario in {type(node) for node in nodes(tree_of("x = 1 if in initial scenario else 2\n", "paper"))}
