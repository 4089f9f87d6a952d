"""`scenic-ref rules`: the catalogue of rules."""

from __future__ import annotations

import inspect
import json
from typing import TYPE_CHECKING, Annotated

import typer

from .options import DebugOption

if TYPE_CHECKING:
    from ..semantics.rules import Rule


def rules(
    prefix: Annotated[str, typer.Argument(metavar="PREFIX", help="Only the rules whose id begins with PREFIX; a whole id explains that rule.")] = "",
    as_json: Annotated[bool, typer.Option("--json", help="As JSON.")] = False,
    debug: DebugOption = False,
) -> None:
    """List the rules of the paper.

    Each has its id, the paper's name, its function, and its place in the paper.
    """
    from ..semantics.rules import CATALOGUE, RULES
    from .text_columns import columns

    known = {name.lower(): rule for name, rule in RULES.items()}
    found = [known[prefix.lower()]] if prefix.lower() in known else [r for r in CATALOGUE if r.id.lower().startswith(prefix.lower())]
    if not found:
        raise unknown_rule(prefix, tuple(RULES))
    if as_json:
        print(json.dumps([rule_json(rule) for rule in found], ensure_ascii=False, indent=2))
    elif prefix.lower() in known:
        print("\n".join(explain_rule(found[0])))
    else:
        print("\n".join(columns(("id", "name in the paper", "function", "place"), [(r.id, r.name, r.code, r.place) for r in found])))


def unknown_rule(name: str, known: tuple[str, ...]) -> Exception:
    """The error for an unknown id."""
    from ..semantics.store.errors import UsageError
    from ..semantics.store.suggestions import did_you_mean

    return UsageError(f"there is no rule {name}", hint=did_you_mean(name, known, "`scenic-ref rules` lists them"))


def rule_json(rule: Rule) -> dict[str, object]:
    """A rule in JSON."""
    from ..semantics.theorems import theorems_of

    return {
        "id": rule.id, "name": rule.name, "place": rule.place, "code": rule.code, "statement": rule.statement, "inherited": rule.inherited,
        "theorems": theorems_of(rule.id),
    }


def explain_rule(rule: Rule) -> list[str]:
    """A rule with the docstring of its function, and the theorems about it."""
    from ..semantics.theorems import theorems_of

    theorems = theorems_of(rule.id)
    return [
        f"{rule.id}: {rule.name}", "", *(inspect.getdoc(rule.function) or "").splitlines(), "",
        f"place     {rule.place}", f"code      {rule.code}",
        *(["theorems  of the theories in proofs/; tests tie these to the code"] if theorems else []), *(f"          {name}" for name in theorems),
    ]
