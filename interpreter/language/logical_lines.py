"""The text that the grammar reads: logical lines that are joined, as in Python, and blanks before the brackets that follow a word of the language.

`[distance⏎    to (3, 4)]` is read as `[distance     to (3, 4)]`: inside brackets, and behind a backslash, a line break is white space, and so
is a comment. `take[1]` is read as `take [1]`, unless the program uses `take` as a name. The grammar has one form of each operator and statement,
and what it says of blanks holds for all of these. `JoinedText` leads from the places in the joined text to those in the text of the user.
"""

from __future__ import annotations

import re
from bisect import bisect_left, bisect_right
from collections.abc import Iterator
from dataclasses import dataclass

TEXT = (
    r"\"\"\"(?:[^\\]|\\[\s\S])*?\"\"\"|'''(?:[^\\]|\\[\s\S])*?'''"
    r"|\"(?:[^\"\\\n]|\\[\s\S])*\"|'(?:[^'\\\n]|\\[\s\S])*'"
)
PIECE = re.compile(rf"(?P<text>{TEXT})|(?P<comment>#[^\n]*)|(?P<slash>\\\n)|(?P<break>\n)|(?P<open>[(\[{{])|(?P<close>[)\]}}])")
"""What matters for the structure of lines."""
BRACKET = re.compile(r"[()\[\]{}]")
CLOSING = {"(": ")", "[": "]", "{": "}"}

COMPOUND = r"(?:if|elif|else|for|while|def|class|try|except|finally|behavior|monitor|scenario|interrupt|setup|compose)\b[^\n]*:"
BEGIN = rf"(?:^(?:[ \t]*{COMPOUND})?|(?<=;))[ \t]*"
TIGHT = re.compile(
    rf"{BEGIN}(?:(?:(?:take|do)(?=\[)|(?:record|simulator)(?=[(\[])|override(?=\())"
    r"|record[ \t]+(?:initial|final)(?=[(\[{])|require(?:[ \t]+|[ \t]*\([( \t]*)(?:always|eventually)(?=\[))",
    re.MULTILINE,
)
"""Words in front of a bracket which begin a statement, unless they are names: the program decides."""
CALLED = re.compile(
    rf"{BEGIN}(?:(?:take|require|do)(?=\()|do[ \t]+(?:choose|shuffle)(?=[(\[])|require[ \t]+(?:always|eventually)(?=\())"
    r"|(?<![\w.])visible(?=\()",
    re.MULTILINE,
)
"""Words in front of a bracket which begin a statement or operator, unless the program defines a function, variable or parameter of that name."""
FOLLOW = re.compile(r"(?<![\w.])follow(?=\()")
FOLLOWED = re.compile(r"[ \t]*(?:from\b|for\b(?![\w,() \t]*[ \t)]in\b))")
"""Behind the bracket of `follow(F)`: the rest of the operator, and not that of a comprehension."""
ASSIGNED = re.compile(r"[^\n;=]*(?<![=!<>])=(?!=)|[ \t]*:(?!=)")
WORD = re.compile(r"(?<!\w)(?:take|do|record|simulator|override|initial|final|always|eventually|follow)\b")
BEFORE = re.compile(r"(?:(?<!\w)\w+|\.)?[ \t]*$")
BEHIND = re.compile(r"[ \t]*(?:[-+*/%@<>=!|^&]*=|[,)\]};:.=+/%@<>|^&]|is\b|and\b|or\b|if\b|else\b|in\b(?![ \t]+initial\b)|for\b|$)", re.MULTILINE)
"""What may stand behind a name, but not behind a word that begins a statement."""
NAMED = r"\b(?P<{}>take|require|do|choose|shuffle|always|eventually|visible)\b"
BOUND = re.compile(
    "|".join((
        r"(?<!\w)(?:def|class|behavior|monitor|scenario|as|for|global|nonlocal|del|import)[ \t]+" + NAMED.format("a"),
        r"^[ \t]*from[^\n]*[ \t]import[ \t][^\n]*" + NAMED.format("b") + r"(?![ \t]+as\b)",
        r"(?<!\w)(?:def|behavior|monitor|scenario)[ \t]+\w+[ \t]*\([^\n]*" + NAMED.format("c") + r"[ \t]*[,)=:]",
        r"(?<!\w)lambda[ \t][^\n:]*" + NAMED.format("d"),
        r"(?<!\w)for[ \t][\w, \t()*]*" + NAMED.format("e") + r"[\w, \t()*]*[ \t]in\b",
        r"(?:^|;)[ \t]*(?:[\w.]+[ \t]*[,=][ \t]*)*" + NAMED.format("f") + r"[ \t]*(?:,[^=\n(]*|:[\w. \t\[\],]*)?=(?!=)",
        NAMED.format("g") + r"[ \t]*:=",
    )),
    re.MULTILINE,
)  # fmt: skip
"""Where a word becomes a name of the program: by a definition, an import, a parameter, a loop or an assignment."""
BINDING = ("def", "class", "behavior", "monitor", "scenario", "as", "import", "for", "global", "nonlocal", "lambda", "del")
ATTRIBUTES = re.compile(r"\[[ \t]*(?:additive|dynamic|final)(?:[ \t]*,[ \t]*(?:additive|dynamic|final))*[ \t]*\](?=[ \t]*:)")
ALL_NAMES = re.compile(r"^[ \t]*(?:from[ \t]+(?!scenic\.)\S+[ \t]+import[ \t]+\*|model[ \t]+(?!scenic\.|gtaLib\b|mars\b))", re.MULTILINE)
"""A module of the user's own may give the program any name."""


@dataclass(frozen=True, slots=True)
class JoinedText:
    """A text for the grammar, and the way back: `added` are the offsets in it of the blanks that the user did not write; `names` are the words that
    the program has as names; `starts` and `joined_starts` are the offsets at which lines begin in the text of the user and in this one.
    """

    text: str
    added: tuple[int, ...] = ()
    names: frozenset[str] = frozenset()
    starts: tuple[int, ...] = ()
    joined_starts: tuple[int, ...] = ()

    def place(self, line: int, column: int) -> tuple[int, int]:
        """Return the line and column in the text of the user for those in the joined text."""
        if not self.starts or line > len(self.joined_starts):
            return line, column
        offset = self.joined_starts[line - 1] + column - 1
        offset -= bisect_left(self.added, offset)
        row = bisect_right(self.starts, offset)
        return row, offset - self.starts[row - 1] + 1


AS_WRITTEN = JoinedText("")
"""Places in it are those in the text of the user."""


def join_text(source: str, *, apart: bool = True, names: frozenset[str] = frozenset()) -> JoinedText:
    """Return `source` with its logical lines joined, and with blanks in front of brackets where the grammar needs them.

    With `apart` that holds for words that may as well be names of a module as well; `names` are words that are names, besides those of `source`.
    """
    joined, plain = join_lines(source)
    names |= bound_words(plain)
    added = tuple(sorted({*(tight_brackets(plain) if apart else ()), *called_brackets(plain, names)}))
    if joined == source and not added:
        return JoinedText(source, names=names)
    pieces: list[str] = []
    last = 0
    for place in added:
        pieces.append(joined[last:place])
        last = place
    text = " ".join([*pieces, joined[last:]])
    places = tuple(place + i for i, place in enumerate(added))
    return JoinedText(text, places, names, line_starts(source), line_starts(text))


def line_starts(text: str) -> tuple[int, ...]:
    """Return the offsets at which the lines of a text begin."""
    return 0, *(match.end() for match in re.finditer("\n", text))


def join_lines(source: str) -> tuple[str, str]:
    """Return two texts of the length of `source`: its logical lines joined, and the same with blanked comments, and dashes for its strings.

    A bracket that is never closed joins nothing: the message about it needs the lines.
    """
    joined, plain = list(source), list(source)
    stack: list[str] = []
    inside: list[tuple[int, int]] = []
    for match in PIECE.finditer(source):
        start, end = match.span()
        match match.lastgroup:
            case "text":
                plain[start:end] = "_" * (end - start)
            case "slash" if source[source.rfind("\n", 0, start) + 1 : start].strip():
                joined[start:end] = plain[start:end] = "  "
            case "open":
                stack.append(match.group())
            case "close" if stack and CLOSING[stack[-1]] == match.group():
                stack.pop()
                if not stack:
                    for first, last in inside:
                        joined[first:last] = plain[first:last] = " " * (last - first)
                    inside.clear()
            case "close":
                break
            case "comment" | "break" if stack:
                inside.append((start, end))
            case "comment":
                plain[start:end] = " " * (end - start)
            case _:
                pass
    return "".join(joined), "".join(plain)


def tight_brackets(plain: str) -> Iterator[int]:
    """Return the offsets of the brackets right behind a word of a statement or operator that is no name in this program."""
    heads, follows = list(TIGHT.finditer(plain)), list(FOLLOW.finditer(plain))
    if not (heads or follows) or ALL_NAMES.search(plain):
        return
    names, closings = words_as_names(ATTRIBUTES.sub("", plain)), closing_brackets(plain)
    for match in (*heads, *follows):
        words = re.findall(r"\w+", match.group())
        closing = closings.get(match.end())
        if words[-1] in names or closing is None:
            continue
        if words == ["follow"]:
            if FOLLOWED.match(plain, closing):
                yield match.end()
        elif not ASSIGNED.match(plain, closing):
            yield match.end()


def called_brackets(plain: str, names: frozenset[str]) -> Iterator[int]:
    """Return the offsets of the brackets right behind a word of a statement or operator that is none of the names."""
    heads = list(CALLED.finditer(plain))
    closings = closing_brackets(plain) if heads else {}
    for match in heads:
        if re.findall(r"\w+", match.group())[-1] not in names and match.end() in closings:
            yield match.end()


def bound_words(plain: str) -> frozenset[str]:
    """Return the words of statements and operators that the program has as names, as far as its own text tells."""
    return frozenset(word for match in BOUND.finditer(plain) for word in match.groups() if word)


def words_as_names(plain: str) -> set[str]:
    """Return the words that stand where only a name can: the program has a variable, function or parameter of that name."""
    found: set[str] = set()
    for match in WORD.finditer(plain):
        before = BEFORE.search(plain, max(0, match.start() - 40), match.start())
        word = before.group().strip() if before else ""
        if word in ("param", "with", "."):  # a parameter, a property or an attribute, and no variable
            continue
        if word in BINDING or BEHIND.match(plain, match.end()):
            found.add(match.group())
    return found


def closing_brackets(plain: str) -> dict[int, int]:
    """Return, for the offset of each bracket that is closed, the offset behind the one that closes it."""
    found: dict[int, int] = {}
    stack: list[int] = []
    for match in BRACKET.finditer(plain):
        if match.group() in CLOSING:
            stack.append(match.start())
        elif stack:
            found[stack.pop()] = match.end()
    return found
