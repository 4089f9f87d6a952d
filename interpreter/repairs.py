"""The most common mistakes and the one repair to suggest for each."""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass

from .formulas import HINT, MESSAGE

SPECIFIERS = (
    "with",
    "at",
    "offset by",
    "offset along",
    "left of",
    "right of",
    "ahead of",
    "behind",
    "beyond",
    "visible",
    "not visible",
    "in",
    "contained in",
    "on",
    "following",
    "facing",
    "facing toward",
    "facing away from",
    "apparently facing",
)
SPECIFIER_START = r"(?:" + "|".join(specifier.replace(" ", r"\s+") for specifier in SPECIFIERS) + r")\b"
BLOCK_START = (
    r"^\s*(?:if|elif|else|for|while|def|class|try|except|finally"
    r"|behavior|monitor|scenario|interrupt\s+when|setup|compose|precondition|invariant)\b"
)
CONDITION_START = r"^\s*(?:require|if|elif|while|assert|until|terminate\s+when|interrupt\s+when)\b"


@dataclass(frozen=True, slots=True)
class Situation:
    """Where parsing stopped: the line, the 0-based column in it, the word there ("" at the end of the line)."""

    line: str
    column: int
    word: str

    @property
    def before(self) -> str:
        """The line up to that column."""
        return self.line[: self.column]

    @property
    def after(self) -> str:
        """The line from that column on."""
        return self.line[self.column :]


@dataclass(frozen=True, slots=True)
class Repair:
    """What is wrong and how to write it."""

    message: str
    hint: str


# (pattern, message, hint): the pattern is looked for in the line, and must touch the place where parsing stopped.
TABLE: tuple[tuple[str, str, str], ...] = (
    (r"\byield\b", "`yield` is not part of the language", "return a list, or write a behavior"),
    (r"^\s*with\b.*", "Python's `with` statement is not part of the language", "use try and finally"),
    (r"\b(?:async|await)\b", "`async` and `await` are not part of the language", "write a behavior"),
    (r"^\s*match\s+.*:\s*$", "Python's `match` statement is not part of the language", "use if and elif"),
    (r":=", "assignment expressions (`:=`) are not part of the language", "assign in a statement of its own"),
    (r"\b(?:above|below)\s+[\w(]", "`above` and `below` are three-dimensional; this reference is two-dimensional", "write `ahead of` or `at`"),
    (r"\baltitude\s+(?:to|from)\b", "`altitude` is three-dimensional; this reference is two-dimensional", "leave it out: it is 0"),
    (
        r"\b(?:top|bottom)(?:\s+(?:front|back))?(?:\s+(?:left|right))?\s+of\b",
        "`top of` and `bottom of` are three-dimensional; this reference is two-dimensional", "write `front of`, `back left of`, ...",
    ),
    (r"\busing\s+\w.*", "specifiers made in Python (`using`) are not part of the language", "write the specifiers that it stands for"),
    (r"^\s*record\b.*\bto\b.*", "values are recorded in the file of the simulation, not `to` another one", "leave out `to ...`"),
    (
        r"^\s*require\b(?!.*\b(?:until|next|always|eventually)\b).*\bimplies\b.*",
        "`implies` is not part of the language", "write `not B or C` for `B implies C`",
    ),
    (
        r"^\s*require\b.*\b(?:until|implies|next|always|eventually)\b.*",
        MESSAGE, HINT,
    ),
    (r"\belse\s+if\b", "`else if` is spelt `elif`", "write `elif`"),
    (r"^\s*(?:elsif|elseif)\b.*", "`elsif` is spelt `elif`", "write `elif`"),
    (r"&&", "`&&` is not an operator", "write `and`"),
    (r"\|\|", "`||` is not an operator", "write `or`"),
    (r"!(?!=)", "`!` is not an operator", "write `not`"),
    (r"(?:\+\+|--)\s*(?:;|#.*)?$", "there is no increment operator", "write `+= 1` or `-= 1`"),
    (r"\bfacing\s+towards\b.*", "`facing towards` is spelt `facing toward`", "write `facing toward`"),
    (r"\bfacing\s+away\b(?!\s+from\b).*", "`facing away` needs `from`", "write `facing away from ...`"),
    (r"\boffset\s*(?!by\b|along\b)(?=[\s(]).", "`offset` needs `by` or `along`", "write `offset by ...`"),
    (r"\b(?:distance|angle)\s+between\b.*", "there is no `between`", "write `from ... to ...`"),
    (r"^\s*require\s+(\d*\.?\d+)\s+\S*", "the probability of a soft requirement stands in brackets", r"write `require[\1] ...`"),
    (r"^\s*mutate\b.*,\s*by\b.*", "there is no comma before `by`", "remove the comma"),
    (r"^\s*param\s+\w+\s*:", "a parameter is set with `=`", "write `param name = value`"),
    (r"\bwith\s+(\w+)\s*[=:]", "`with` takes the property and its value without `=`", r"write `with \1 ...`"),
    (CONDITION_START + r"[^=]*[^=!<>]=(?!=)", "`=` assigns", "write `==` to compare"),
    (r"\b(?:degrees?|degs)\b", "the unit of angles is spelt `deg`", "write `deg`"),
    (r"\b(?:secs?|second)\b", "the unit of time is spelt `seconds`", "write `seconds`"),
    (r"\bstep\b", "the unit of time steps is spelt `steps`", "write `steps`"),
    (r"\b(?:metres?|meters?)\b", "lengths are in metres and have no unit", "leave out the unit"),
    (r"\b(left\s+of|right\s+of|ahead\s+of|behind)\s+(\S+)\s+(-?[\d.]+)", "the distance needs `by`", r"write `\1 \2 by \3`"),
    (r"\bbeyond\s+\S+\s+\(", "the offset needs `by`", "write `beyond ... by ...`"),
    (r"^\s*print\s+\S.*", "`print` is a function", "write `print(...)`"),
    (r"^\s*(?:var|let|const|function|func)\s+\w.*", "there are no declarations", "write `name = value` or `def name():`"),
    (r"^\s*(behavior|monitor|scenario)\s+(\w+)\s*$", "a `:` is missing at the end of the line", r"write `\1 \2():`"),
    (r"[“”‘’«»]", "these quotation marks are not those of the language", "write \" or '"),
    (r"[\u00a0\u2000-\u200b\u3000\ufeff]", "this white space is not that of the language", "write an ordinary space"),
    (r"[−–—]", "this dash is not a minus sign", "write -"),
    (r"\\\s+$", "white space follows the backslash that continues the line", "remove the white space"),
    (r"[?$`]", "this character has no meaning here", "remove it"),
)

NEEDS_ARGUMENT = re.compile(
    r"(visible\s+from|left\s+of|right\s+of|ahead\s+of|front\s+of|back\s+of|behind|beyond|facing\s+toward|facing\s+away\s+from|facing|following"
    r"|offset\s+by|offset\s+along|relative\s+to|can\s+see|at|on|by|with(?:\s+\w+)?|distance\s+(?:from|to|past)|angle\s+(?:from|to)|from|to)\s*$"
)


def find(place: Situation) -> Repair | None:
    """The repair of the mistake at `place`, if it is a known one."""
    for pattern, message, hint in TABLE:
        for match in re.finditer(pattern, place.line):
            if match.start() <= place.column <= match.end():
                return Repair(message, match.expand(hint) if "\\" in hint else hint)
    return _ended(place) or _unknown_specifier(place)


def _ended(place: Situation) -> Repair | None:
    """A line that ends too early."""
    if place.word:
        return None
    if re.match(BLOCK_START, place.line) and not place.before.rstrip().endswith(":"):
        return Repair("a `:` is missing at the end of the line", "end the line with `:`")
    found = NEEDS_ARGUMENT.search(place.before)
    if found:
        return Repair(f"`{' '.join(found.group(1).split())}` needs an argument", f"write `{' '.join(found.group(1).split())} ...`")
    return None


def _unknown_specifier(place: Situation) -> Repair | None:
    """A word where a specifier or an operator could stand."""
    if re.match(SPECIFIER_START, place.after) and re.search(r"\S\s*$", place.before):
        return Repair(f"a comma is missing before `{place.word}`", "separate specifiers with commas")
    earlier = re.search(r",\s*([^\W\d]\w*)\s+$", place.before)
    if earlier and _nearest(earlier.group(1)) and not re.match(SPECIFIER_START, earlier.group(1)):
        return Repair(f"`{earlier.group(1)}` is not a specifier", f"did you mean `{_nearest(earlier.group(1))}`?")
    if not re.match(r"[^\W\d]\w*$", place.word) or not re.search(r"[\w)\]]\s*$|,\s*$", place.before):
        return None
    if re.match(BLOCK_START, place.line) and place.line.lstrip().split()[0] not in ("if", "elif", "while", "for"):
        return Repair("the head of this definition is malformed", "write `name(parameters):`")
    near = _nearest(place.word)
    return Repair(f"`{place.word}` is not a specifier or operator", f"did you mean `{near}`?") if near else None


def _nearest(word: str) -> str | None:
    """The specifier whose first word is most like `word`, if one is."""
    first_words = {specifier.split()[0]: specifier for specifier in reversed(SPECIFIERS)}
    near = difflib.get_close_matches(word, list(first_words), n=1, cutoff=0.6)
    return first_words[near[0]] if near else None
