"""Messages for a text that is not a program: the place, what was expected, and one repair for the most common
mistakes.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from lark import Token
from lark.exceptions import UnexpectedCharacters, UnexpectedInput, UnexpectedToken
from lark.parsers.lalr_parser_state import ParserState

from ...semantics.store.errors import ParseError
from ...semantics.store.suggestions import nearest
from ...semantics.syntax import Span
from . import temporal_formulas
from .temporal_formulas import misplaced_operator_message, with_probability
from .tree_builder import PARTS, TextOrigin

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
    """The situation in which parsing stopped: the line, the 0-based column in it, the word there ("" at the
    end of the line), the line above, and whether the dialect is one of the releases.
    """

    line: str
    column: int
    word: str
    above: str = ""
    released: bool = False

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
    """The description of a mistake and its repair; `place` is the mistake in the line, from one 0-based
    column to another, if parsing stopped later.
    """

    message: str
    hint: str
    place: tuple[int, int] | None = None


RESERVED = (
    "and|as|assert|async|await|break|class|continue|def|del|elif|else|except|finally|for|from|global|if|import|in|is|lambda|nonlocal|not|or|pass"
    "|raise|return|try|while|with|yield|True|False|None"
)
AMOUNT = r"(?P<n>[^\W\d][\w.]*\([^()]*\)|\([^()]*\)|[\d.]*\d)"
"""What stands before a unit: a number, or a distribution such as `Range(3, 5)`."""
LENGTH = rf"{AMOUNT}(?:\s*(?:m|met(?:re|er)s?)\b)?"
"""Such an amount, perhaps with a unit."""
MEASURED = r"(?P<spec>(?:left|right|ahead)\s+of|behind|beyond)\s+(?P<o>[^\W\d][\w.]*)"
# (pattern, message, hint): the pattern is looked for in the line, and must touch the place where parsing stopped; its group `here` is the mistake.
TABLE: tuple[tuple[str, str, str], ...] = (
    (
        rf"^\s*(?P<here>{RESERVED})\s*=(?!=)",
        r"`\g<here>` is a word of the language, and no name for a variable", r"write another name, such as `\g<here>_`",
    ),
    (
        r"^\s*(?P<here>setup|compose)(?=\s*:)(?:\s*:\s*(?:#.*)?$)?", r"`\g<here>` stands only in a `scenario`",
        PARTS["setup"][1],
    ),
    (r"\byield\b", "`yield` is not part of the language", "return a list, or write a behavior"),
    (r"^\s*with\b.*", "Python's `with` statement is not part of the language", "use try and finally"),
    (r"\b(?:async|await)\b", "`async` and `await` are not part of the language", "write a behavior"),
    (r"^\s*match\s+.*:\s*$", "Python's `match` statement is not part of the language", "use if and elif"),
    (r"^\s*\w+\s*:=", "`:=` does not assign", "write `=`"),
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
        r"^\s*(?:require(?:\s*\[[^]]*\])?(?:\s+(?:always|eventually))?|(?:terminate|interrupt)\s+when)\s+(?P<here>that)\s+[\w(]",
        "the condition follows at once, without `that`", "leave it out",
    ),
    (
        r"^\s*interrupt\s+(?P<here>if|while|once|on)\b.*:.*", "an interrupt begins with `interrupt when`",
        "write `interrupt when ...:`",
    ),
    (
        r"^\s*(?P<here>interrupt)(?!\s+when\b)(?=\s|\(|:).*:\s*(?:#.*)?$", "an interrupt begins with `interrupt when`",
        "write `interrupt when ...:`",
    ),
    (
        rf"(?<=[\w)\]])\s+(?P<here>by\s+(?:{LENGTH}|(?P<v>[^\W\d][\w.]*)))(?=\s+{MEASURED})", "`by` stands behind what the distance is measured from",
        r"write `\g<spec> \g<o> by \g<n>\g<v>`",
    ),
    (
        rf"(?<=[\w)\]])\s+(?P<here>{LENGTH})(?=\s+{MEASURED})", "the distance stands behind what it is measured from, with `by`",
        r"write `\g<spec> \g<o> by \g<n>`",
    ),
    (
        r"^\s*do\b(?!\s+(?:choose|shuffle)\b).*[\w)\]},]\s+(?P<here>then|followed\s+by)\s+[^\W\d].*",
        "what runs one after the other is written as two statements",
        "write the second in a line of its own; a comma would run both at the same time",
    ),
    (
        r"^\s*(?:take|wait|do\s+(?:choose|shuffle))\b.*\s(?P<here>then|followed\s+by)\s+[\w(].*",
        "what runs one after the other is written as two statements", "write the second in a line of its own",
    ),
    (r"(?:^|;)\s*(?P<here>then)\s+[^\W\d]", "`then` is not part of the language: statements run one after the other", "leave it out"),
    (r"\belse\s+if\b", "`else if` is spelt `elif`", "write `elif`"),
    (r"^\s*(?:elsif|elseif)\b.*", "`elsif` is spelt `elif`", "write `elif`"),
    (r"(?P<here>&&)", "`&&` is not an operator", "write `and`"),
    (r"(?P<here>\|\|)", "`||` is not an operator", "write `or`"),
    (r"!(?!=)", "`!` is not an operator", "write `not`"),
    (r"(?P<here>\+\+|--)\s*(?:;|#.*)?$", "there is no increment operator", "write `+= 1` or `-= 1`"),
    (r"\b(?i:facing)\s+(?P<here>towards)\b.*", "`facing towards` is spelt `facing toward`", "write `facing toward`"),
    (r"\bfacing\s+away\b(?!\s+from\b).*", "`facing away` needs `from`", "write `facing away from ...`"),
    (r"\boffset\s*(?!by\b|along\b)(?=[\s(]).", "`offset` needs `by` or `along`", "write `offset by ...`"),
    (r"\b(?:distance|angle)\s+(?P<here>between)\b.*", "there is no `between`", "write `from ... to ...`"),
    (r"\[\s*(?P<here>[\d.]+\s*%)\s*\]", "a probability is a number from 0 to 1, without `%`", "write `require[0.5] ...` for 50 %"),
    (
        r"^\s*require\s*(?P<here>\(\s*(?P<p>\d*\.?\d+)\s*\))\s*[^\W\d]\w*", "the probability of a soft requirement stands in square brackets",
        r"write `require[\g<p>] ...`",
    ),
    (
        r"\b(?P<word>and|or)\s+(?P<here>(?:[<>]=?|==|!=)\s*[\w.-]+)", r"`\g<word>` stands between two whole conditions",
        r"say again what is compared, as in `x < -3 \g<word> x > 3`",
    ),
    (r"^\s*(?P<here>(?:stop|end|finish|exit|quit|halt)\s+(?P<word>when|if|after))\b", r"`\g<here>` is not a statement", "write `terminate when ...`"),
    (r"^\s*require\s+(?P<here>\d*\.?\d+)\s+\S*", "the probability of a soft requirement stands in brackets", r"write `require[\g<here>] ...`"),
    (
        r"^\s*param\s+(?P<name>[^\W\d]\w*)\s*(?P<here>\[)", "a parameter is set as a whole, not an element of it",
        r"write `param \g<name> = ...` with the whole list or dictionary",
    ),
    (
        r"^\s*param\s+(?P<name>[^\W\d]\w*)(?P<here>\.)(?P<rest>[\w.]*)", "the name of a parameter has no dot",
        r'write another name, such as `\g<name>_\g<rest>`, or `param "\g<name>.\g<rest>" = ...`',
    ),
    (r"^\s*mutate\b.*,\s*by\b.*", "there is no comma before `by`", "remove the comma"),
    (r"^\s*param\s+\w+\s*(?P<here>:)", "a parameter is set with `=`", "write `param name = value`"),
    (r"^\s*param\s+\w+\s+(?P<here>[\w.\"'(]+)", "a parameter is set with `=`", "write `param name = value`"),
    (
        r"\bwith\s*(?P<here>\()\s*(?P<name>[^\W\d]\w*)", "`with` is followed by the property and its value, without brackets around them",
        r"write `with \g<name> ...`",
    ),
    (r"\bwith\s+(\w+)\s*(?P<here>[=:])", "specifiers take no `=`: `with` is followed by the property and its value", r"write `with \1 ...`"),
    (
        r"^\s*(?P<here>interrupt\s+when)\b", "`interrupt when` stands without a `try` above it",
        "write `try:` above the statements that it interrupts, and indent them",
    ),
    (rf"\b(?P<specifier>{SPECIFIER_START})\s*(?P<here>=)(?!=)", "specifiers take no `=`", r"write `\g<specifier> ...`"),
    (CONDITION_START + r"[^=]*[^=!<>]=(?!=)", "`=` assigns", "write `==` to compare"),
    (
        r"^\s*terminate\s+(?P<here>if)\b(?!.*\belse\b).*", "the condition of `terminate` begins with `when`", "write `terminate when ...`",
    ),
    (
        r"^\s*do\b.*[\w)\]]\s+(?P<here>while)\s+(?P<c>[^#:]*[^#:\s])", "`do` goes on `until` a condition holds, not `while` it does",
        r"write `until not (\g<c>)`",
    ),
    (
        r"^\s*(?P<here>precondition|invariant)\s+[^\s:].*", r"a `:` is missing after `\g<here>`", r"write `\g<here>: ...`",
    ),
    (
        r"^\s*(?P<word>model|import)\s+(?P<here>(?P<mark>['\"])(?P<name>[\w.]+)(?P=mark))",
        "the name of a module stands without quotation marks", r"write `\g<word> \g<name>`",
    ),
    (
        r"^\s*mutate\s(?P<names>[\w\s,]*?)\s*\b(?P<here>\d[\d.]*)\s*(?:#.*)?$", "the amount of noise needs `by`",
        r"write `mutate \g<names> by \g<here>`",
    ),
    (
        r"\b(?P<here>(?P<which>relative|apparent)\s+heading)\s+(?!of\b)(?P<o>[^\W\d][\w.]*)", r"`\g<which> heading` needs `of`",
        r"write `\g<which> heading of \g<o>`",
    ),
    (
        r"\b(?P<here>deg)\s*\(\s*(?P<n>[^()]*[^()\s])\s*\)", "`deg` is a unit and stands behind the number", r"write `\g<n> deg`",
    ),
    (
        r"\bfollowing\s+(?P<field>[\w.]+)\s+for\s+(?P<n>[\w.]+(?:\([^()]*\))?)\s+(?P<here>from\s+(?P<o>[^\W\d][\w.]*))",
        "`from` stands before `for`", r"write `following \g<field> from \g<o> for \g<n>`",
    ),
    (
        r"^\s*wait\s+(?P<here>\d[\d.]*)\s*(?:#.*)?$", "`wait` lets one time step pass, and takes no number",
        r"write `for i in range(\g<here>):` with `wait` as its block",
    ),
    (
        r"^\s*param\s+[^\W\d]\w*\s*=.*[\w)\]'\"]\s+(?P<here>[^\W\d]\w*)\s*=(?!=)", r"a comma is missing before `\g<here>`",
        "separate parameters with commas",
    ),
    (
        r"^\s*(?:if|elif|else|while|for|behavior|monitor|scenario|def|class|try|setup|compose)\b.*(?P<here>\{)\s*(?:#.*)?$",
        "a block begins with `:` and is indented; there are no braces around it", "write `:`, and remove the `}` behind the block",
    ),
    (r"\b(?:degrees?|degs)\b", "the unit of angles is spelt `deg`", "write `deg`"),
    (r"\b(?:secs?|second)\b", "the unit of time is spelt `seconds`", "write `seconds`"),
    (rf"\b(?:for|after|every)\s+{AMOUNT}\s*(?P<here>s)\b", "the unit of time is spelt `seconds`", "write `seconds`"),
    (
        rf"\b(?:for|after|every)\s+{AMOUNT}\s*(?P<here>m(?:in(?:ute)?s?)?)\b", "times are in seconds or in time steps",
        r"write `\g<n> * 60 seconds`",
    ),
    (
        rf"\b(?:for|after|every)\s+{AMOUNT}\s*(?P<here>ms|milliseconds?)\b", "times are in seconds or in time steps",
        r"write `\g<n> / 1000 seconds`",
    ),
    (r"\bstep\b", "the unit of time steps is spelt `steps`", "write `steps`"),
    (r"(?P<here>°)", "the unit of angles is spelt `deg`", "write `deg`"),
    (rf"{AMOUNT}\s*(?P<here>(?:km\s*/?\s*h|kmph|kph)\b)", "speeds are in metres per second and have no unit", r"write `\g<n> / 3.6`"),
    (rf"{AMOUNT}\s*(?P<here>mph\b)", "speeds are in metres per second and have no unit", r"write `\g<n> * 0.44704`"),
    (r"[\d)]\s*(?P<here>m\s*/\s*s\b)", "speeds are in metres per second and have no unit", "leave out the unit"),
    (rf"{AMOUNT}\s*(?P<here>km\b)", "lengths are in metres and have no unit", r"write `\g<n> * 1000`"),
    (rf"{AMOUNT}\s*(?P<here>cm\b)", "lengths are in metres and have no unit", r"write `\g<n> / 100`"),
    (rf"{AMOUNT}\s*(?P<here>mm\b)", "lengths are in metres and have no unit", r"write `\g<n> / 1000`"),
    (rf"{AMOUNT}\s*(?P<here>(?:ft|feet)\b)", "lengths are in metres and have no unit", r"write `\g<n> * 0.3048`"),
    (r"[\d)]\s*(?P<here>m\b)", "lengths are in metres and have no unit", "leave out the unit"),
    (r"\b(?:metres?|meters?)\b", "lengths are in metres and have no unit", "leave out the unit"),
    (
        r",\s*(?P<here>(?P<word>width|length|height|color|name|speed|behavior|model|viewAngle|allowCollisions|requireVisible))\s+[^\s=]\S*",
        r"`\g<here>` is a property, and a specifier is needed", r"write `with \g<word> ...`",
    ),
    (r",\s*(?P<here>heading)\s+[^\s=]\S*", "`heading` is a property, and a specifier is needed", "write `facing ...`"),
    (r",\s*(?P<here>position)\s+[^\s=]\S*", "`position` is a property, and a specifier is needed", "write `at ...`"),
    (r"\b(left\s+of|right\s+of|ahead\s+of|behind)\s+(\S+)\s+(-?[\d.]+)", "the distance needs `by`", r"write `\1 \2 by \3`"),
    (r"\b(?P<here>left|right)\s+by\b", r"`\g<here>` needs `of`", r"write `\g<here> of X by S`"),
    (r"\bbeyond\s+\S+\s+\(", "the offset needs `by`", "write `beyond ... by ...`"),
    (r"^\s*(?P<here>print)\s+\S.*", "`print` is a function", "write `print(...)`"),
    (r"^\s*(?P<here>var|let|const|function|func)\s+\w.*", "there are no declarations", "write `name = value` or `def name():`"),
    (r"^\s*(behavior|monitor|scenario)\s+(\w+)\s*$", "a `:` is missing at the end of the line", r"write `\1 \2():`"),
    (r"\b(?P<here>in\s*front\s+of)\s.*", "`in front of` is spelt `ahead of`", "write `ahead of X by S`"),
    (r"\b(?P<here>(?:next|close|near)\s*to)\b", r"there is no `\g<here>`", "write `left of X by S`, `ahead of X by S`, ..."),
    (r"\b(?P<here>(?P<word>behind|beyond|following|facing|visible)\s+of)\b\s*", r"`\g<word>` takes no `of`", r"write `\g<word> ...`"),
    (
        r"(?P<what>[\w.]+)\s+(?P<here>can\s+be\s+seen)\b(?:\s+(?:by|from)\s+(?P<who>\w+))?",
        "`can be seen` is not an operator", r"the one that sees stands first: write `ego can see \g<what>`",
    ),
    (r"(?<=[\w)\]])\s+(?P<here>can\s+(?!see\b)se\w{0,3}|sees)\b", r"`\g<here>` is not an operator", "write `can see`"),
    (r"\b(?P<here>(?P<first>left|right|ahead|front|back)of)\b\s*", r"`\g<here>` is two words", r"write `\g<first> of`"),
    (r"\b(?P<here>distance|angle)\s+(?!(?:from|to|of|past)\b)[\w(]\S*", r"`\g<here>` needs `from` or `to`", r"write `\g<here> from ... to ...`"),
    (r"\(\s*-?[\d.]+\s+(?P<here>-?[\d.]+)\s*\)", "a comma is missing between two numbers", "write `(x, y)`"),
    (r"^\s*(?:if|elif|while|for)\b.*\s(?P<here>then|do)\b", r"`\g<here>` is not part of the language", "write `:`"),
    (r"^\s*(?P<here>else|elif|except|finally)\b", r"no block above goes on with `\g<here>` here", "align it with the statement that it belongs to"),
    (r"(?P<here>,)\s*(?:#.*)?$", "a comma stands at the end of the statement", "remove it"),
    (r"(?P<here>;)\s*;", "a statement is missing between two `;`", "remove one"),
    (r"[“”‘’«»]", "these quotation marks are not those of the language", "write \" or '"),
    (r"[\u00a0\u2000-\u200b\u3000\ufeff]", "this white space is not that of the language", "write an ordinary space"),
    (r"[−–—]", "this dash is not a minus sign", "write -"),
    (r"\\\s+$", "white space follows the backslash that continues the line", "remove the white space"),
    (r"[?$`]", "this character has no meaning here", "remove it"),
)

NEEDS_ARGUMENT = re.compile(
    r"\b(visible\s+from|left\s+of|right\s+of|ahead\s+of|front\s+of|back\s+of|behind|beyond|facing\s+toward|facing\s+away\s+from|facing|following"
    r"|offset\s+by|offset\s+along|relative\s+to|can\s+see|at|on|by|with(?:\s+\w+)?|distance\s+(?:from|to|past)|angle\s+(?:from|to)|from|to)\s*$"
)


def find(place: Situation) -> Repair | None:
    """The repair of the mistake at `place`, if it is a known one."""
    if place.above.split("#")[0].rstrip().endswith(",") and re.match(rf"{SPECIFIER_START}\s*\S", place.line):
        return Repair("a specifier that goes on with an object definition is not indented", "indent the line")
    found = temporal_formulas.STEPS.search(place.line) if place.word == "steps" else None
    if found is not None and found.end() >= place.column:
        word, time = " ".join(found["word"].split()), " ".join(found["time"].split())
        said = temporal_formulas.time_condition_message(word, time)
        hint = temporal_formulas.instead(word, time, found["amount"], released=place.released)
        return Repair(said, hint, found.span("time"))
    if (words := _without_argument(place)) is not None:
        return _needs_argument(words)
    if (repair := _comment(place) or _formula(place)) is not None:
        return repair
    for pattern, message, hint in TABLE:
        for match in re.finditer(pattern, place.line):
            if match.start() <= place.column <= match.end():
                said, repair = (match.expand(text) if "\\" in text else text for text in (message, hint))
                return Repair(said, repair, _here(match))
    return _line_end_repair(place) or _second_condition(place) or _unknown_statement(place) or _unknown_specifier(place)


def _here(match: re.Match[str]) -> tuple[int, int] | None:
    """Return the place of the mistake according to the pattern, if the pattern marks one."""
    return match.span("here") if "here" in match.re.groupindex and match["here"] is not None else None


COMMENT = re.compile(r"//|/\*")
AS_PROSE = re.compile(r"(?://|/\*)\s*[^\W\d]\w*\s+$")


def _comment(place: Situation) -> Repair | None:
    """A comment as in other languages: where no operator can stand, or with two words one behind the other."""
    for found in COMMENT.finditer(place.line, 0, place.column + 2):
        before, within = place.line[: found.start()].rstrip(), place.line[found.start() : place.column]
        words = re.match(rf"(?!{SPECIFIER_START}|(?:{'|'.join(INFIX)})\b)[^\W\d]", place.after)
        prose = AS_PROSE.match(within) is not None and words is not None
        if not before or before[-1] in ",:([{=" or found.group() == "/*" or prose or not place.word:
            message = "`//` divides, and a comment begins with `#`" if found.group() == "//" else "a comment begins with `#`"
            return Repair(message, "write `# ...`", found.span())
    return None


def _formula(place: Situation) -> Repair | None:
    """An operator over time, or `implies`, within the condition of a requirement: where parsing stopped, or right before."""
    head = re.match(r"\s*require\b(?P<soft>\s*\[[^]]*\])?", place.line)
    for found in re.finditer(r"\b(?:until|implies|next|always|eventually)\b", place.line) if head is not None else ():
        near = found.start() == place.column or not place.line[found.end() : place.column].strip()
        grouped = place.word in ("and", "or", "implies", "until") and re.search(r"\(\s*$", place.line[: found.start()]) is not None
        if head is not None and found.start() <= place.column and (near or grouped):
            if head["soft"] and not place.line[head.end() : found.start()].strip():
                return Repair(*with_probability(found.group()), found.span())
            before = place.line[head.end() : found.start()]
            return Repair(*misplaced_operator_message(found.group(), before, place.line[found.end() :]), found.span())
    return None


def _line_end_repair(place: Situation) -> Repair | None:
    """A line that ends too early."""
    if place.word:
        return None
    if re.match(BLOCK_START, place.line) and not place.before.rstrip().endswith(":"):
        return Repair("a `:` is missing at the end of the line", "end the line with `:`")
    found = NEEDS_ARGUMENT.search(place.before)
    if found:
        return _needs_argument(found[1])
    return None


def _without_argument(place: Situation) -> str | None:
    """The operator or specifier with nothing behind it but a comma or the end of the brackets; a word alone may be a name."""
    found = NEEDS_ARGUMENT.search(place.before) if place.word in (",", ")", "]", "}") else None
    if found is None:
        return None
    follows = re.search(r"[\w)\]]\s+$", place.before[: found.start()]) is not None
    return found[1] if follows or found[1] == "with" or len(found[1].split()) > 1 else None


def _needs_argument(words: str) -> Repair:
    """The repair of an operator or specifier, in `words`, with nothing behind it."""
    word = " ".join(words.split())
    return Repair(f"`{word}` needs an argument", f"write `{word} ...`")


def _second_condition(place: Situation) -> Repair | None:
    """A comma behind the condition of a statement that takes one."""
    found = re.match(r"\s*(require|terminate\s+when|assert)\b", place.before)
    if place.word != "," or found is None:
        return None
    word = " ".join(found[1].split())
    return Repair(f"`{word}` takes one condition", f"write `{word}` once for each, or join them with `and`")


def _unknown_statement(place: Situation) -> Repair | None:
    """A line whose first word is like that of a statement, and parsing stopped right behind it."""
    first = re.match(r"\s*([^\W\d]\w*)\s+$", place.before)
    near = nearest(first[1], STATEMENTS) if first else None
    if first is None or near is None or re.match(SPECIFIER_START, place.after):
        return None
    return Repair(f"`{first[1]}` is not a statement", f"did you mean `{near}`?", first.span(1))


def _unknown_specifier(place: Situation) -> Repair | None:
    """A word where a specifier or an operator could stand."""
    if re.match(SPECIFIER_START, place.after) and re.search(r"\S\s*$", place.before):
        return Repair(f"a comma is missing before `{place.word}`", "separate specifiers with commas")
    if (half := re.match(r"(left|right|ahead)\s+(?!(?:of|and|or|if|else|in|is|not|for)\b)[^\W\d]", place.after)) is not None:
        return Repair(f"`{half[1]}` is no specifier without `of`", f"write `{half[1]} of ...`")
    earlier = re.search(r",\s*([^\W\d]\w*)\s+$", place.before)
    if earlier and (near := _nearest(earlier[1])) and not re.match(SPECIFIER_START, earlier[1]):
        return Repair(f"`{earlier[1]}` is not a specifier", f"did you mean `{near}`?", earlier.span(1))
    before = re.search(r"([^\W\d]\w*)\s+$", place.before)
    if before and (near := nearest(before[1], PREFIXES)):
        return Repair(f"`{before[1]}` is not an operator", f"did you mean `{near}`?", before.span(1))
    if not re.match(r"[^\W\d]\w*$", place.word) or not re.search(r"[\w)\]]\s*$|,\s*$", place.before):
        return None
    if re.match(BLOCK_START, place.line) and place.line.lstrip().split()[0] not in ("if", "elif", "while", "for", "interrupt"):
        return Repair("the head of this definition is malformed", "write `name(parameters):`")
    near = _nearest(place.word) or nearest(place.word, INFIX)
    return Repair(f"`{place.word}` is not a specifier or operator", f"did you mean `{near}`?") if near else None


STATEMENTS = (
    "require", "param", "model", "mutate", "terminate", "record", "import", "from", "behavior", "monitor", "scenario", "class", "def", "return",
    "while", "for", "raise", "assert", "global", "nonlocal", "take", "override", "del",
)
PREFIXES = ("distance", "angle", "relative", "apparent", "follow", "visible")
INFIX = ("from", "for", "until", "and", "not", "else", "relative", "offset", "deg", "seconds", "steps")


def _nearest(word: str) -> str | None:
    """The specifier whose first word is most like `word`, if one is."""
    first_words = {specifier.split()[0]: specifier for specifier in reversed(SPECIFIERS)}
    near = nearest(word, first_words)
    return first_words[near] if near is not None else None


EXPECTED_LIMIT = 8
WORD = re.compile(r"[^\W\d]\w*|\d[\w.]*|\S")
BLOCK_WORD = re.compile(r"\s*(setup|compose|try|else|finally|precondition|invariant)\s*(?:#.*)?$")
BRACKET_OR_TEXT = re.compile(
    r"#[^\n]*|\"\"\"(?:[^\\]|\\[\s\S])*?\"\"\"|'''(?:[^\\]|\\[\s\S])*?'''|\"(?:[^\"\\\n]|\\[\s\S])*\"|'(?:[^'\\\n]|\\[\s\S])*'|[()\[\]{}]"
)
COMMA_OR_BRACKET = re.compile(
    rf"{BRACKET_OR_TEXT.pattern}|(?<!,)\n|,\s*(?P<word>(?!visible\s*[,)\]]){SPECIFIER_START})(?=\s+[\w(.\-\"']|\()"
)
CODE = re.compile(r"(?:\"(?:[^\"\\]|\\.)*\"|'(?:[^'\\]|\\.)*'|[^#])*")
OBJECT = re.compile(
    r"\s*(?:return\s+|(?:[^\W\d][\w.]*\s*=\s*)+)?(?P<new>new\s+)?(?:[^\W\d]\w*\.)*[A-Z]\w*(?=\s*,?\s*$|\s+" + SPECIFIER_START + r")"
)
"""An object definition that is a statement, or the value of an assignment or `return`, up to its class."""
PAIRS = {")": "(", "]": "[", "}": "{"}

# The names that a user knows terminals by, the most telling first.
HUMAN: dict[str, tuple[str, ...]] = {
    "an indented block": ("_INDENT",),
    "`:`": ("COLON",),
    "`)`": ("RPAR",),
    "`]`": ("RSQB",),
    "`}`": ("RBRACE",),
    "`=`": ("EQUAL",),
    "an expression": ("NUMBER",),
    "a name": ("NAME",),
    "`,`": ("COMMA",),
    "`by`": ("_BY",),
    "`from`": ("_FROM",),
    "`to`": ("_TO",),
    "`for`": ("_FOR",),
    "`import`": ("_IMPORT",),
    "`else`": ("_ELSE",),
    "a specifier": ("_FACING", "_WITH"),
    "an operator": ("DEG",),
    "a string": ("STRING",),
    "the end of the line": ("_NEWLINE",),
}


def explain(fault: UnexpectedInput, source: str, origin: TextOrigin, *, released: bool = False) -> ParseError:
    """The error for Lark's `fault` in `source`, which stands at `origin`; `released`: in a dialect of the releases."""
    line, column = fault_place(fault, source, origin)
    lines = source.split("\n")
    text = lines[line - 1] if line <= len(lines) else ""
    found = WORD.match(text, column - 1)
    word = found.group() if found and not found.group().startswith("#") else ""
    end = column + max(1, len(word))
    span = origin.written(line, column, line, end)
    unclosed = bracket_fault(source, line, column, word, ended=getattr(getattr(fault, "token", None), "type", "") == "$END")
    if unclosed is not None:
        (at_line, at_column), message, hint = unclosed
        return ParseError(message, origin.written(at_line, at_column, at_line, at_column + 1), hint=hint)
    expected = expected_names(fault)
    if isinstance(fault, UnexpectedCharacters) and re.match(r"(?i)(?:[rbuf]{0,2})['\"]", text[column - 1 :]):
        return ParseError("this string is not terminated", span, hint="end it with the quotation mark it began with")
    kind = fault.token.type if isinstance(fault, UnexpectedToken) else ""
    bare = BLOCK_WORD.match(lines[line - 2]) if kind == "_INDENT" and line > 1 else None
    if bare is not None:
        place = origin.written(line - 1, bare.end(1) + 1, line - 1, bare.end(1) + 2)
        return ParseError("a `:` is missing at the end of the line", place, hint=f"write `{bare[1]}:`")
    if kind == "_INDENT":
        return specifiers_without_comma(lines[: line - 1], text, origin) or ParseError(
            "unexpected indentation", span, hint="align the line with the one before"
        )
    above = lines[line - 2] if line > 1 else ""
    if expected == ("an indented block",) and not word:
        return no_block(lines[: line - 1], text, span)
    repair = find(
        Situation(text, column - 1 if word else len(text.rstrip()), word, above, released=released)
    )
    if repair is not None and repair.place is not None:
        start, stop = repair.place
        return ParseError(repair.message, origin.written(line, start + 1, line, stop + 1), hint=repair.hint)
    if repair is not None:
        return ParseError(repair.message, span, expected=expected, hint=repair.hint)
    if expected == ("an indented block",):
        return no_block(lines[: line - 1], text, span)
    return ParseError(unexpected_word_message(word, kind, expected), span, expected=expected)


def code_of(line: str) -> str:
    """A line of the text without its comment and the white space around it on the right."""
    found = CODE.match(line)
    return "" if found is None else found.group().rstrip()


def specifiers_without_comma(above: list[str], text: str, origin: TextOrigin) -> ParseError | None:
    """The error for an indented line of specifiers behind a line of an object that does not end with a comma; None for other lines."""
    number = next((i for i in range(len(above), 0, -1) if code_of(above[i - 1])), 0)
    found = re.match(rf"\s*(?P<comma>,\s*)?(?P<rest>{SPECIFIER_START}(?!\s*[=.,)\]]).*)", code_of(text))
    if not number or found is None or text.rstrip().endswith(":"):
        return None
    first = number
    while first > 1 and code_of(above[first - 2]).endswith(","):
        first -= 1
    statement = " ".join(code_of(line) for line in above[first - 1 : number])
    head = OBJECT.match(statement)
    if head is None or statement.endswith(";") or re.search(r"\b[A-Z_\d]{2,}$", head.group()):  # a constant, by its letters
        return None
    column = len(code_of(above[number - 1])) + 1
    if found["comma"]:
        place = origin.written(len(above) + 1, found.start("comma") + 1, len(above) + 1, found.start("comma") + 2)
        return ParseError("a line of specifiers does not begin with a comma", place, hint="move it to the end of the line before")
    if head.end() == len(statement) and not head["new"]:
        place = origin.written(len(above) + 1, found.start("rest") + 1, len(above) + 1, found.end("rest") + 1)
        return ParseError("the first specifier stands in the line of its class", place, hint="move it to the end of the line before")
    hint = "end each line of specifiers but the last with `,`"
    return ParseError("a comma is missing at the end of the line", origin.written(number, column, number, column + 1), hint=hint)


def no_block(above: list[str], text: str, span: Span) -> ParseError:
    """The error for `text`, a line that should be the first of a block and is not indented."""
    expected, hint = ("an indented block",), "indent the line, or write `pass`"
    number = next((i for i in range(len(above), 0, -1) if code_of(above[i - 1])), 0)
    head = code_of(above[number - 1]).strip() if number else ""
    if not head.endswith(":") or re.match(BLOCK_START, head) is None or not text.strip():
        return ParseError("expected an indented block", span, expected=expected, hint=hint)
    if head.startswith("class") and re.match(r"\s*[^\W\d]\w*\s*(?:\[[\w\s,]*\]\s*)?:|\s*def\b", text):
        hint = "indent the lines of the class"
    return ParseError(f"the block of `{head}` (line {number}) is not indented", span, expected=expected, hint=hint)


def unexpected_word_message(word: str, kind: str, expected: tuple[str, ...]) -> str:
    """The message for a mistake that is not a known one."""
    what = f"unexpected `{word}`" if word else "the text ends too early" if kind == "$END" else "the line ends too early"
    return what + (f"; expected {' or '.join(expected[-3:] if len(expected) > 3 else expected)}" if expected else "")


def fault_place(fault: UnexpectedInput, source: str, origin: TextOrigin) -> tuple[int, int]:
    """The 1-based line and column in `source` where parsing stopped."""
    if isinstance(fault, UnexpectedToken) and isinstance(fault.token, Token) and fault.token.type in ("$END", "_NEWLINE", "_DEDENT"):
        line, column = fault.token.end_line, fault.token.end_column
    else:
        line, column = getattr(fault, "line", None), getattr(fault, "column", None)
    if not isinstance(line, int) or not isinstance(column, int) or line < 1:
        return source.count("\n") or 1, 1
    return origin.joined.place(line, max(1, column))


def expected_names(fault: UnexpectedInput) -> tuple[str, ...]:
    """The human names of what could have stood there, at most EXPECTED_LIMIT."""
    state = getattr(fault, "state", None)
    if isinstance(state, ParserState):
        terminals = acceptable(state)
    else:
        terminals = set(getattr(fault, "allowed", None) or ())
    names = [name for name, kinds in HUMAN.items() if terminals & set(kinds)]
    if "an expression" in names:
        names = [name for name in names if name not in ("a name", "a string", "`from`", "`for`", "`import`", "an operator")]
    return tuple(names[:EXPECTED_LIMIT])


def acceptable(state: ParserState) -> set[str]:
    """The terminals with which parsing could go on: the table's candidates, each tried on a copy of the stack."""
    found: set[str] = set()
    for terminal in state.parse_conf.parse_table.states[state.position]:
        if not terminal.isupper():
            continue
        try:
            state.copy(deepcopy_values=False).feed_token(Token(terminal, ""), terminal == "$END")
        except UnexpectedToken:
            continue
        found.add(terminal)
    return found


def bracket_fault(source: str, line: int, column: int, word: str, *, ended: bool) -> tuple[tuple[int, int], str, str] | None:
    """The place, message and hint for a bracket that is closed too often, wrongly, or never."""
    stack = open_brackets(source, len(source) if ended else offset_of(source, line, column))
    if word in PAIRS:
        if not stack:
            return (line, column), f"`{word}` closes no bracket", "remove it, or open a bracket before it"
        opening, start = stack[-1]
        if opening != PAIRS[word]:
            message = f"`{word}` does not close the `{opening}` of line {source.count(chr(10), 0, start) + 1}"
            closing = next(key for key, value in PAIRS.items() if value == opening)
            return (line, column), message, f"write `{closing}`"
    elif stack:
        opening, start = stack[-1]
        opened = source.count("\n", 0, start) + 1
        if ended or (opened < line and not is_closed(source, start)):
            message = f"this `{opening}` is never closed"
            closing = next(key for key, value in PAIRS.items() if value == opening)
            found = specifier_inside(source, start)
            hint = f"add `{closing}`" if found is None else f"add `{closing}` before `, {found}`"
            return (opened, start - source.rfind("\n", 0, start)), message, hint
    return None


def offset_of(source: str, line: int, column: int) -> int:
    """The offset of a place in a text."""
    return max(0, sum(len(text) + 1 for text in source.split("\n")[: line - 1]) + column - 1)


def open_brackets(source: str, stop: int) -> list[tuple[str, int]]:
    """The brackets that are open at an offset, with the offsets where they stand, the innermost last."""
    stack: list[tuple[str, int]] = []
    for match in BRACKET_OR_TEXT.finditer(source, 0, stop):
        char = match.group()
        if char in PAIRS.values():
            stack.append((char, match.start()))
        elif char in PAIRS and stack:
            stack.pop()
    return stack


def specifier_inside(source: str, start: int) -> str | None:
    """The first word of a specifier behind a comma in the bracket at `start`, if it is one of the object outside: the bracket belongs before it."""
    before = code_of(source[source.rfind("\n", 0, start) + 1 : start])
    depth = 0
    for match in COMMA_OR_BRACKET.finditer(source, start):
        char = match.group()
        depth += (char[0] in PAIRS.values()) - (char[0] in PAIRS)
        if depth == 0 or char == "\n":
            return None
        if match["word"] and depth == 1:
            outside = re.search(rf"[\w)\]]\s+{SPECIFIER_START}", before) is not None
            inside = re.search(rf"\b{SPECIFIER_START}", source[start : match.start()]) is not None
            return match["word"] if outside and not inside else None
    return None


def inside_brackets(source: str, specifier: Span) -> ParseError | None:
    """The error for a specifier that stands inside brackets, and belongs to the object outside of them; None for others."""
    stack = open_brackets(source, offset_of(source, specifier.line, specifier.column)) if source else []
    word = specifier_inside(source, stack[-1][1]) if stack else None
    if word is None:
        return None
    start = stack[-1][1]
    line = source.count("\n", 0, start) + 1
    where = "" if line == specifier.line else f"line {line}, "
    message = f"a specifier stands inside the brackets that begin at {where}column {start - source.rfind(chr(10), 0, start)}"
    return ParseError(message, specifier, hint=f"close them before `, {word}`")


def is_closed(source: str, start: int) -> bool:
    """Return whether the bracket at `start` is closed further on, so that the mistake is another one."""
    depth = 0
    for match in BRACKET_OR_TEXT.finditer(source, start):
        char = match.group()
        depth += (char in PAIRS.values()) - (char in PAIRS)
        if depth == 0:
            return True
    return False

