"""The most common mistakes and the one repair to suggest for each."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ..semantics.kernel.suggestions import nearest
from . import time_conditions
from .definition_parts import PARTS
from .formulas import misplaced, with_probability

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
    """Where parsing stopped: the line, the 0-based column in it, the word there ("" at the end of the line), the line
    above, and whether the dialect is one of the releases.
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
    """What is wrong and how to write it; `place` is the mistake in the line, from one 0-based column to another, if parsing stopped later."""

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
    found = time_conditions.STEPS.search(place.line) if place.word == "steps" else None
    if found is not None and found.end() >= place.column:
        word, time = " ".join(found["word"].split()), " ".join(found["time"].split())
        said = time_conditions.message(word, time)
        hint = time_conditions.instead(word, time, found["amount"], released=place.released)
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
    return _ended(place) or _second_condition(place) or _unknown_statement(place) or _unknown_specifier(place)


def _here(match: re.Match[str]) -> tuple[int, int] | None:
    """Where the pattern says that the mistake is."""
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
            return Repair(*misplaced(found.group(), before, place.line[found.end() :]), found.span())
    return None


def _ended(place: Situation) -> Repair | None:
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
