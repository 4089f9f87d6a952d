"""Places in a text as editors count them: lines from 0, and columns in units of UTF-8, UTF-16 or UTF-32."""

from __future__ import annotations

import re
from bisect import bisect_right

END = re.compile(r"\r\n|\r|\n")
"""What ends a line in the protocol, and to the parser; `str.splitlines` knows of more."""
UTF_8, UTF_16, UTF_32 = "utf-8", "utf-16", "utf-32"


class TextLines:
    """A text with the beginnings of its lines."""

    def __init__(self, text: str, encoding: str = UTF_16) -> None:
        self.text = text
        self.encoding = encoding
        ends = list(END.finditer(text))
        self.starts = [0, *(end.end() for end in ends)]
        self.stops = [*(end.start() for end in ends), len(text)]

    def offset(self, line: int, units: int) -> int:
        """The index in the text of a place; one beyond a line is its end, one beyond the text the end of that, one inside a character its start."""
        if line < 0 or line >= len(self.starts):
            return len(self.text) if line >= 0 else 0
        start, stop = self.starts[line], self.stops[line]
        if self.encoding == UTF_32 or self.text.isascii():
            return min(start + max(units, 0), stop)
        while start < stop and units > 0:
            units -= width(self.text[start], self.encoding)
            start += units >= 0
        return start

    def place(self, offset: int) -> tuple[int, int]:
        """The line and the column, in units, of an index in the text."""
        line = bisect_right(self.starts, offset) - 1
        start = self.starts[line]
        return line, units_in(self.text[start : min(offset, self.stops[line])], self.encoding)

    def index(self, line: int, column: int) -> int:
        """The index in the text of a place as the parser counts: from 1, in characters, without a byte order mark."""
        line = min(max(line, 1), len(self.starts))
        mark = 1 if line == 1 and self.text.startswith("\ufeff") else 0
        return min(self.starts[line - 1] + mark + max(column, 1) - 1, self.stops[line - 1])


def width(char: str, encoding: str) -> int:
    """How many units a character takes."""
    if encoding == UTF_16:
        return 2 if ord(char) > 0xFFFF else 1
    return len(char.encode("utf-8", "surrogatepass")) if encoding == UTF_8 else 1


def units_in(text: str, encoding: str) -> int:
    """How many units a text takes."""
    return len(text) if text.isascii() or encoding == UTF_32 else sum(width(char, encoding) for char in text)
