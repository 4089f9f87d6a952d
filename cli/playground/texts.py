"""Values and texts of programs as the page shows them: neither too long nor able to hide what they say."""

from __future__ import annotations

from ..session import escaped

LONGEST_TEXT, LONGEST_LIST, DEEPEST = 400, 100, 6

Json = dict[str, object]


def cut(value: object, depth: int = 0) -> object:
    """A value in JSON, shortened where it is long or deep; control characters, and those that turn the direction of writing, are escaped."""
    match value:
        case str():
            return cut_text(value)
        case list() if depth < DEEPEST:
            rest = [f"… {len(value) - LONGEST_LIST:,} more"] if len(value) > LONGEST_LIST else []
            return [cut(v, depth + 1) for v in value[:LONGEST_LIST]] + rest
        case dict() if depth < DEEPEST:
            return {cut_text(str(k)): cut(v, depth + 1) for k, v in list(value.items())[:LONGEST_LIST]}
        case list() | dict():
            return "…"
        case int() if not isinstance(value, bool) and value.bit_length() > 53:
            return cut_text(hex(value))
        case _:
            return value


def cut_text(text: str, longest: int = LONGEST_TEXT) -> str:
    """A text that is not too long."""
    return escaped(text if len(text) <= longest else f"{text[:longest]}… ({len(text):,} characters)")


IN_PAGE = (
    ("give --trust if you know the code", "start `scenic-ref play --trust` if you know the code"),
    ("--limit-memory allows more", "start `scenic-ref play` with a larger --limit-memory"),
    ("--limit-seconds allows more", "start `scenic-ref play` with a larger --limit-seconds"),
    ("raise --fuel if it really takes that long", "if it really takes that long, start `scenic-ref play` with a larger --fuel"),
    ("try --backend smc, or more --max-attempts", "make them less strict here, or save the program, and use `scenic-ref run --backend smc`"),
    ("the interpreter can: --backend interpreter", "save the program, and use `scenic-ref run`"),
    ("(-p map=site.geojson)", "(`scenic-ref play --map site.geojson`)"),
)
"""Advice for a command line, and what it is on the page."""


def on_page(advice: str) -> str:
    """The advice for who has the page, where it is for who has a command line."""
    for command, page in IN_PAGE:
        advice = advice.replace(command, page)
    return advice
