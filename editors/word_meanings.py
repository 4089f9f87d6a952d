"""Descriptions of the language's words, properties and built-in names; rules are those of the catalogue."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator, Mapping
from functools import cache
from typing import NamedTuple

from ..interpreter.language.keywords import LanguageWord
from ..interpreter.language.printer import to_source
from ..semantics.machine.values import Constructor
from ..semantics.python.builtins import BUILTINS
from ..semantics.rules import CATALOGUE, Rule
from ..semantics.scenes import released_forms, specifiers
from ..semantics.store.built_in_classes import (
    BOOLEAN_PROPERTIES,
    BUILT_IN_CLASSES,
    NON_NEGATIVE_PROPERTIES,
    SCALAR_PROPERTIES,
    VECTOR_PROPERTIES,
)
from ..semantics.store.scenic_classes import ScenicClass
from ..semantics.syntax import dynamics as d
from ..semantics.syntax import expressions as e
from ..semantics.syntax import specifiers as q
from ..semantics.syntax import statements as s
from ..semantics.syntax.nodes import Expression, Node
from ..semantics.syntax.python_expressions import Comparison


class Use(NamedTuple):
    """A construct that a word begins or belongs to: the node, which says how it is written, and the beginnings of the ids of its rules."""

    node: type[Node]
    rules: tuple[str, ...]


WORDS: Mapping[str, tuple[Use, ...]] = {
    "_WITH": (Use(q.WithSpecifier, ("P-With",)),),
    "AT": (Use(q.AtSpecifier, ("P-At",)), Use(e.FieldAt, ("O-At",))),
    "OFFSET_BY": (Use(q.OffsetBySpecifier, ("P-OffsetBy",)), Use(e.OffsetBy, ("O-OffsetBy",))),
    "OFFSET_ALONG": (Use(q.OffsetAlongSpecifier, ("P-OffsetAlong",)), Use(e.OffsetAlong, ("O-OffsetAlong",))),
    "_LEFT_OF": (Use(q.BesideSpecifier, ("P-LeftOf", "P-Beside")), Use(e.SideOf, ("O-LeftOf",))),
    "_RIGHT_OF": (Use(q.BesideSpecifier, ("P-RightOf", "P-Beside")), Use(e.SideOf, ("O-RightOf",))),
    "_AHEAD_OF": (Use(q.BesideSpecifier, ("P-AheadOf", "P-Beside")),),
    "_BEHIND": (Use(q.BesideSpecifier, ("P-Behind", "P-Beside")),),
    "_BEYOND": (Use(q.BeyondSpecifier, ("P-Beyond",)),),
    "VISIBLE_LONE": (Use(q.VisibleSpecifier, ("P-Visible",)),),
    "VISIBLE_FROM": (Use(q.VisibleSpecifier, ("P-Visible",)), Use(e.VisibleFrom, ("O-VisibleFrom",))),
    "NOT_VISIBLE_LONE": (Use(q.NotVisibleSpecifier, ("P-NotVisible",)),),
    "NOT_VISIBLE_FROM": (Use(q.NotVisibleSpecifier, ("P-NotVisible",)), Use(e.NotVisible, ("O-NotVisible",))),
    "_ON": (Use(q.InSpecifier, ("P-In", "P-On-Vector")),),
    "IN": (Use(q.InSpecifier, ("P-In",)), Use(Comparison, ("O-In", "E-Compare")), Use(s.For, ("S-For",))),
    "_CONTAINED_IN": (Use(q.ContainedInSpecifier, ("P-ContainedIn",)),),
    "_FOLLOWING": (Use(q.FollowingSpecifier, ("P-Following",)),),
    "_FACING": (Use(q.FacingSpecifier, ("P-Facing",)),),
    "FACING_TOWARD": (Use(q.FacingTowardSpecifier, ("P-FacingToward",)),),
    "FACING_AWAY_FROM": (Use(q.FacingAwayFromSpecifier, ("P-FacingAwayFrom",)),),
    "_APPARENTLY_FACING": (Use(q.ApparentlyFacingSpecifier, ("P-ApparentlyFacing",)),),
    "NEW": (Use(e.ObjectDefinition, ("E-ObjectDefinition", "R-ResolveSpecifiers")),),
    "DEG": (Use(e.Degrees, ("O-Deg",)),),
    "SECONDS": (Use(e.Seconds, ("E-Seconds",)),),
    "CAN_SEE": (Use(e.CanSee, ("O-CanSee",)),),
    "INTERSECTS": (Use(e.Intersects, ("O-Intersects",)),),
    "RELATIVE_TO": (Use(e.RelativeTo, ("O-RelativeTo",)),),
    "RELATIVE_POSITION_OF": (Use(e.RelativePosition, ("O-RelativePosition",)),),
    "_RELATIVE_HEADING_OF": (Use(e.RelativeHeading, ("O-RelativeHeading",)),),
    "_APPARENT_HEADING_OF": (Use(e.ApparentHeading, ("O-ApparentHeading",)),),
    "_DISTANCE": (Use(e.Distance, ("O-Distance",)), Use(e.DistancePast, ("O-DistancePast",))),
    "_PAST": (Use(e.DistancePast, ("O-DistancePast",)),),
    "_ANGLE": (Use(e.Angle, ("O-Angle",)),),
    "_FOLLOW": (Use(e.Follow, ("O-Follow",)),),
    "_VISIBLE": (Use(e.Visible, ("O-Visible",)),),
    "NOT_VISIBLE": (Use(e.NotVisible, ("O-NotVisible",)),),
    "SIDE_OF": (Use(e.SideOf, ("O-FrontOf", "O-BackOf", "O-FrontLeftOf", "O-FrontRightOf", "O-BackLeftOf", "O-BackRightOf")),),
    "IN_INITIAL_SCENARIO": (Use(e.InInitialScenario, ("E-InInitialScenario",)),),
    "INITIAL_SCENARIO": (Use(e.InInitialScenario, ("E-InInitialScenario",)),),
    "_MODEL": (Use(s.Model, ("S-Model",)),),
    "_PARAM": (Use(s.Param, ("S-Param",)),),
    "_REQUIRE": (Use(s.Require, ("S-Require",)),),
    "_REQUIRE_SOFT": (Use(s.SoftRequire, ("S-SoftReq",)),),
    "_REQUIRE_ALWAYS": (Use(d.RequireAlways, ("D-Always",)),),
    "_REQUIRE_EVENTUALLY": (Use(d.RequireEventually, ("D-Eventually",)),),
    "ALWAYS": (Use(d.RequireAlways, ("D-Always",)),),
    "EVENTUALLY": (Use(d.RequireEventually, ("D-Eventually",)),),
    "REQUIRE_MONITOR": (Use(d.RequireMonitor, ("D-Policy-3",)),),
    "_TERMINATE_WHEN": (Use(d.TerminateWhen, ("D-TerminateWhen",)),),
    "_TERMINATE_SIMULATION_WHEN": (Use(d.TerminateWhen, ("D-TerminateWhen",)),),
    "_TERMINATE_AFTER": (Use(d.TerminateAfter, ("D-TerminateAfter",)),),
    "TERMINATE_SIMULATION": (Use(d.Terminate, ("D-Terminate",)),),
    "TERMINATE": (Use(d.Terminate, ("D-Terminate",)),),
    "_RECORD": (Use(d.Record, ("D-Record",)),),
    "_RECORD_INITIAL": (Use(d.Record, ("D-Record",)),),
    "_RECORD_FINAL": (Use(d.Record, ("D-Record",)),),
    "_EVERY": (Use(d.Record, ("D-Record",)),),
    "_AFTER": (Use(d.Record, ("D-Record",)),),
    "_SIMULATOR": (Use(s.ChooseSimulator, ("S-Simulator",)),),
    "MUTATE": (Use(s.Mutate, ("S-Mutate", "T-Mutate")),),
    "_MUTATE_BY": (Use(s.Mutate, ("S-Mutate", "T-Mutate")),),
    "_TAKE": (Use(d.Take, ("D-Take",)),),
    "WAIT": (Use(d.Wait, ("D-Wait",)),),
    "_WAIT_FOR": (Use(d.WaitFor, ("D-WaitFor",)),),
    "_WAIT_UNTIL": (Use(d.WaitFor, ("D-WaitFor",)),),
    "ABORT": (Use(d.Abort, ("D-Abort",)),),
    "_DO": (Use(d.Do, ("D-Do",)),),
    "_DO_CHOOSE": (Use(d.DoChoose, ("D-Choose",)),),
    "_DO_SHUFFLE": (Use(d.DoShuffle, ("D-Choose",)),),
    "_UNTIL": (Use(d.Until, ("D-Do-Return",)),),
    "STEPS": (Use(d.TimeLimit, ("D-Do-Return",)),),
    "_OVERRIDE": (Use(d.Override, ("D-Override",)),),
    "_INTERRUPT_WHEN": (Use(s.Interrupt, ("D-Interrupt", "D-Try")),),
    "_TRY": (Use(s.Try, ("D-Try", "S-Except")),),
    "_BEHAVIOR": (Use(d.BehaviorDefinition, ("S-Definition",)),),
    "_MONITOR": (Use(d.MonitorDefinition, ("S-Definition", "D-Policy-3")),),
    "_SCENARIO": (Use(d.ScenarioDefinition, ("S-Definition",)),),
    "_PRECONDITION": (Use(d.BehaviorDefinition, ("D-Precondition", "D-Initial")),),
    "_INVARIANT": (Use(d.BehaviorDefinition, ("D-Invariant",)),),
    "_SETUP": (Use(d.ScenarioDefinition, ("D-Setup",)),),
    "_COMPOSE": (Use(d.ScenarioDefinition, ("D-Policy-1", "D-Scenario-End")),),
    "CLASS": (Use(s.ClassDefinition, ("S-Class",)),),
    "CONSTRUCTOR": (Use(s.ClassDefinition, ("S-Class",)),),
    "_DEF": (Use(s.FunctionDefinition, ("S-Def",)),),
    "_IF": (Use(s.If, ("S-If", "E-Branch", "E-Conditional")),),
    "_ELIF": (Use(s.If, ("S-If", "E-Branch")),),
    "_WHILE": (Use(s.While, ("S-While", "E-Branch")),),
    "_FOR": (Use(s.For, ("S-For",)),),
    "BREAK": (Use(s.Break, ("S-Break",)),),
    "CONTINUE": (Use(s.Continue, ("S-Break",)),),
    "_RETURN": (Use(s.Return, ("S-Return",)),),
    "_ASSERT": (Use(s.Assert, ("S-Assert",)),),
    "_RAISE": (Use(s.Raise, ("S-Raise",)),),
    "_EXCEPT": (Use(s.Handler, ("S-Except",)),),
    "_FINALLY": (Use(s.Try, ("S-Finally",)),),
    "_DEL": (Use(s.Delete, ("S-Delete",)),),
    "_IMPORT": (Use(s.Import, ("S-Import",)),),
    "PASS": (Use(s.Pass, ()),),
}
"""The terminals of the grammar that begin a construct. What is left out means what it does in Python, or belongs to another word."""

NAMES_WITH_RULES: Mapping[str, tuple[str, ...]] = {"resample": ("E-Resample",), "print": ("E-Print",)}

MEANINGS: Mapping[str, str] = {
    "position": "where the centre is, in metres: East, North",
    "heading": "which way it faces: radians anticlockwise from North",
    "viewDistance": "how far it sees, in metres",
    "visibleDistance": "how far it sees, in metres: the name of the releases for `viewDistance`",
    "viewAngle": "how wide it sees, in radians, half of it to each side of the heading",
    "mutationScale": "how strongly `mutate` disturbs it; 0 not at all",
    "positionStdDev": "the standard deviation, in metres, that `mutate` adds to each coordinate, for a scale of 1",
    "headingStdDev": "the standard deviation, in radians, that `mutate` adds to the heading, for a scale of 1",
    "width": "the extent across the heading, in metres",
    "length": "the extent along the heading, in metres",
    "speed": "the initial speed along the heading, in metres per second",
    "velocity": "the initial velocity, in metres per second",
    "angularSpeed": "the initial rate of turning, in radians per second, anticlockwise",
    "behavior": "what the object does over time: an invoked behavior, or None",
    "allowCollisions": "whether its box may overlap those of others",
    "requireVisible": "whether ego must be able to see it",
    "regionContainedIn": "the region that must contain its whole box, None for the workspace",
}
"""What the built-in properties say."""

OURS = (__package__ or "").partition(".")[0]
SPECIAL = re.compile(r"([\\*_<>#|\[\]])")


@cache
def rules_of(beginnings: tuple[str, ...]) -> tuple[Rule, ...]:
    """The rules whose ids are one of these, or go on from one behind a hyphen."""
    return tuple(rule for b in beginnings for rule in CATALOGUE if rule.id == b or rule.id.startswith(f"{b}-"))


def escape_markdown(text: str) -> str:
    """A text as Markdown that shows it as it is, but for code between backticks."""
    parts = text.split("`")
    return "`".join(part if number % 2 else SPECIAL.sub(r"\\\1", part) for number, part in enumerate(parts))


def first_sentence(what: object) -> str:
    """The first paragraph of a docstring."""
    return " ".join((inspect.getdoc(what) or "").partition("\n\n")[0].split())


@cache
def about_word(word: LanguageWord) -> str:
    """A word of the language in Markdown: how its constructs are written, with their rules; \"\" if there is nothing to say."""
    return "\n\n---\n\n".join(about_use(use) for use in WORDS.get(word.name, ()))


def about_use(use: Use) -> str:
    """A construct in Markdown."""
    kind = "specifier" if issubclass(use.node, q.Specifier) else "operator" if issubclass(use.node, Expression) else "statement"
    return "\n\n".join([f"*{kind}* {first_sentence(use.node)}", *(about_rule(rule) for rule in rules_of(use.rules))])


def about_rule(rule: Rule) -> str:
    """A rule in Markdown: its id, what it says, what a specifier specifies, its place in the paper."""
    return "  \n".join([f"**{rule.id}**", escape_markdown(rule.statement), *specified_by(rule.id), f"*{escape_markdown(rule.place)}*"])


@cache
def forms() -> tuple[specifiers.Form, ...]:
    """Every form of a specifier but `with`."""
    tables = (*(f for _, f in released_forms.FORMS.values()), *specifiers.BESIDE.values(), *specifiers.OFFSET_BY.values())
    more = (*released_forms.BESIDE.values(), *released_forms.ORIENTED_OFFSETS.values(), (released_forms.BEYOND,))
    return tuple(form for forms_ in (*tables, *more) for form in forms_)


def specified_by(rule: str) -> Iterator[str]:
    """Yield the properties that the specifier of a rule specifies, and its dependencies."""
    for form in forms():
        if form.rule == rule:
            optional = form.optional + (("heading",) if form.heading_of_region else ())
            text = "specifies " + quote_names(form.specifies)
            text += f", optionally {quote_names(optional)}" if optional else ""
            yield text + (f"; depends on {quote_names(form.dependencies)}" if form.dependencies else "")


def quote_names(names: tuple[str, ...]) -> str:
    """Return the names as code in Markdown."""
    return ", ".join(f"`{name}`" for name in names)


def specifiers_of(name: str) -> str:
    """The specifiers of a property, as they are written, those that specify it optionally apart."""
    always, optionally = {f"`with {name} E`": None}, {}
    for use in (use for uses in WORDS.values() for use in uses if issubclass(use.node, q.Specifier)):
        rules = {rule.id for rule in rules_of(use.rules)}
        mine = [form for form in forms() if form.rule in rules]
        written = dict.fromkeys(re.findall("`[^`]+`", re.split("[:;]", first_sentence(use.node))[0]))
        if any(name in form.specifies for form in mine):
            always |= written
        elif any(name in form.optional or (form.heading_of_region and name == "heading") for form in mine):
            optionally |= written
    return ", ".join(always) + (f"; optionally by {', '.join(optionally)}" if optionally else "")


def kind_of(name: str) -> str:
    """The kind of values that a built-in property has."""
    if name in VECTOR_PROPERTIES:
        return "vector"
    if name in BOOLEAN_PROPERTIES:
        return "True or False"
    if name in SCALAR_PROPERTIES:
        return "number, not negative" if name in NON_NEGATIVE_PROPERTIES else "number"
    return "any value"


@cache
def about_built_in_property(name: str) -> str:
    """A property of the built-in classes in Markdown; \"\" for another."""
    known = "viewDistance" if name == "visibleDistance" else name
    class_ = next((c for c in BUILT_IN_CLASSES.values() if known in c.own_defaults), None)
    if class_ is None:
        return ""
    lines = [
        f"*property* `{name}` of `{class_.name}`", escape_markdown(MEANINGS[name]),
        f"a {kind_of(name)}, by default `{default_text(class_, known)}`".replace("a True", "True").replace("a any", "any"),
        f"specified by {specifiers_of(name)}",
    ]
    return "  \n".join(lines)


def default_text(class_: ScenicClass, name: str) -> str:
    """The default value expression of a property as source text."""
    if name in ("viewAngle", "headingStdDev"):
        return "360 deg" if name == "viewAngle" else "5 deg"
    value = getattr(class_.own_defaults[name], "value", None)
    return str(value) if name == "position" else to_source(class_.own_defaults[name])


def about_built_in(name: str) -> str:
    """A name that every program has, in Markdown: a class with its properties, a distribution with its parameters, a function; \"\" for another."""
    if name not in BUILTINS:
        return ""
    value = BUILTINS[name]
    lines = [f"```scenic\n{signature(name)}\n```"]
    if isinstance(value, ScenicClass):
        lines += ["\n".join(f"- `{p}`: `{default_text(c, p)}`, {escape_markdown(MEANINGS[p])}" for c in value.lineage for p in c.own_defaults)]
    elif isinstance(value, Constructor):
        lines += [about_rule(rule) for rule in rules_of(("E-Distributions",))]
    elif name in NAMES_WITH_RULES:
        lines += [about_rule(rule) for rule in rules_of(NAMES_WITH_RULES[name])]
    elif callable(value) or type(value).__module__.startswith(OURS):
        lines += [escape_markdown(first_sentence(value))]
    return "\n\n".join(line for line in lines if line)


@cache
def signature(name: str) -> str:
    """How a built-in name is used, in one line."""
    value = BUILTINS[name]
    if isinstance(value, ScenicClass):
        above = ", ".join(c.name for c in value.superclasses)
        return f"class {name}({above})" if above else f"class {name}"
    if isinstance(value, Constructor):
        return f"{name}({value.takes})"
    if isinstance(value, type) and not issubclass(value, Exception) and value.__module__.startswith(OURS):
        return f"{name}({', '.join(p for p in inspect.signature(value).parameters)})"
    return f"{name}(...)" if callable(value) else name
