"""Literals as source text; f-strings are special, since an interpolation has neither backslashes nor the outer quotes."""



from __future__ import annotations

import math
from abc import ABC, abstractmethod

from ..semantics.syntax import Expression
from ..semantics.syntax.python_expressions import Constant, FormattedValue, FString
from .dialects import Dialect

QUOTES = ('"""', "'''", '"', "'")


class NoQuotesLeft(ValueError):
    """The text cannot stand inside these quotes."""


def constant(value: object) -> str:
    """The literal of a constant."""
    if value is ...:
        return "..."
    if isinstance(value, float) and math.isinf(value):
        return "1e999"
    if isinstance(value, int) and not isinstance(value, bool) and abs(value) >= 10**4000:
        return hex(value)
    return repr(value)


class StringPrinter(ABC):
    """The part of the printer for strings; `outer` are the quotes of the f-strings around, which cannot occur inside them."""

    def __init__(self, dialect: Dialect, outer: tuple[str, ...] = ()) -> None:
        self.dialect = dialect
        self.outer = outer

    @abstractmethod
    def test(self, node: Expression) -> str:
        """The text of an expression."""

    def print_Constant(self, node: Constant) -> str:
        value = node.value
        if not self.outer or not isinstance(value, str | bytes):
            return constant(value)
        prefix, text = ("b", value.decode("latin-1")) if isinstance(value, bytes) else ("", value)
        for quote in QUOTES:
            if self.fits(text, quote):
                return prefix + quote + text + quote
        raise NoQuotesLeft("no quotes are left for a string")

    def fits(self, text: str, quote: str) -> bool:
        """Whether `text` can stand between these quotes as it is, within the f-strings around."""
        literal = quote + text + quote
        alone = quote not in text + quote[1:] and (len(quote) == 3 or "\n" not in text)
        return alone and not any(mark in literal for mark in self.outer) and "\\" not in text

    def print_FString(self, node: FString) -> str:
        """The literal of an f-string, in the first quotes that do."""
        for quote in QUOTES:
            try:
                return f"f{quote}{self.inside(node, quote)}{quote}"
            except NoQuotesLeft:
                continue
        raise NoQuotesLeft("no quotes are left for an f-string")

    def inside(self, node: FString, quote: str, *, layout: bool = False) -> str:
        """The text between the quotes (`layout`: of a format specification)."""
        texts = [self.literal(part, quote, layout) if isinstance(part, str) else self.replacement(part, quote) for part in node.parts]
        return "".join(texts)

    def literal(self, text: str, quote: str, layout: bool) -> str:
        """Literal characters of an f-string: escaped, or as they are inside another f-string."""
        if not self.outer:
            body = "".join([_escape(char) for char in text])
            return body.replace("{", "\\x7b").replace("}", "\\x7d") if layout else body.replace("{", "{{").replace("}", "}}")
        if not self.fits(text, quote) or (layout and ("{" in text or "}" in text)):
            raise NoQuotesLeft("a literal piece does not fit")
        return text.replace("{", "{{").replace("}", "}}")

    def within(self, quote: str) -> StringPrinter:
        """A printer of what stands in an f-string between such quotes."""
        return type(self)(self.dialect, (*self.outer, quote))

    def replacement(self, part: FormattedValue, quote: str) -> str:
        """`{(value)!conversion:format}`."""
        text = self.within(quote).test(part.value)
        if "\\" in text or quote in text:
            raise NoQuotesLeft("an interpolation does not fit")
        conversion = f"!{part.conversion}" if part.conversion else ""
        layout = "" if part.format is None else ":" + self.inside(part.format, quote, layout=True)
        return f"{{({text}){conversion}{layout}}}"


def _escape(char: str) -> str:
    return {"'": "\\'", '"': '\\"'}.get(char) or repr(char)[1:-1]
