"""Texts made by Python's methods and formats, where a short call could read what is private or make more than fits into memory."""

from __future__ import annotations

import operator
import re
from collections.abc import Mapping, Sequence
from string import Formatter
from typing import Any

from ..machine.value_nesting import check_written
from ..machine.values import arguments_of, unwrap
from ..store.budget import Budget, as_whole_number, container_length, refuse_too_long
from ..store.errors import FuelExhausted, RunError, without_addresses

NUMBER = re.compile(r"\d+")
DIRECTIVE = re.compile(r"%(?:\([^)]*\))?[#0\- +]*(\*|\d+)?(?:\.(\*|\d+))?")


def check_specification(specification: str) -> str:
    """A format specification whose width and precision are no larger than a text may be. Raises `RunError`."""
    for digits in NUMBER.findall(specification):
        refuse_too_long(int(digits) if len(digits) < 12 else 10**12)
    return specification


def in_this_run(value: object) -> object:
    """An exception of the program whose arguments are random, with those of this run; anything else as it is."""
    if not isinstance(value, BaseException) or unwrap(arguments_of(value))[1] is None:
        return value
    arguments: Any = unwrap(arguments_of(value))[0]
    told = type(value).__new__(type(value), *arguments)
    told.__dict__.update(value.__dict__)
    return told


def addressless_repr(value: object) -> str:
    """`repr(value)`, never with an address in memory, which would differ from run to run."""
    check_written(value)
    return without_addresses(repr(in_this_run(value)))


def addressless_str(value: object) -> str:
    """`str(value)`, never with an address in memory."""
    check_written(value)
    return str(value) if isinstance(value, str) else without_addresses(str(in_this_run(value)))


def too_many_digits(problem: ValueError) -> bool:
    """Whether Python refused to write a whole number, for its many digits."""
    text = problem.args[0] if problem.args else None  # what it is made of may be the program's, with a `__str__` of its own
    return type(text) is str and text.startswith("Exceeds the limit")


def addressless_format(value: object, specification: str = "") -> str:
    """`format(value, specification)`."""
    if not isinstance(specification, str):
        raise TypeError("a format specification must be a text")
    check_written(value)
    text = format(in_this_run(value), check_specification(specification))
    return text if isinstance(value, str) else without_addresses(text)


class Fields(Formatter):
    """`str.format`, whose fields are arguments and their elements; what an f-string can say need not be said by attributes."""

    def get_field(self, field_name: str, args: Sequence[Any], kwargs: Mapping[str, Any]) -> Any:
        """The value of a field such as `0[name]`, and which argument it is from."""
        first, rest = field_name.split("[", 1)[0].split(".", 1)[0], field_name
        key: int | str = int(first) if first.isdigit() else first
        found = self.get_value(key, args, kwargs)
        rest = field_name[len(first) :]
        while rest:
            match = re.match(r"\[([^]]*)\]", rest)
            if match is None:
                raise RunError("a format string reads no attributes", rule="E-Call-Host", hint="write an f-string: f'{x.name}'")
            index = match.group(1)
            found = operator.getitem(found, int(index) if index.isdigit() else index)
            rest = rest[match.end() :]
        return found, key

    def convert_field(self, value: Any, conversion: str | None) -> Any:
        """The value as `!r`, `!s` or `!a` ask for it."""
        text = {"r": addressless_repr, "a": addressless_repr, "s": addressless_str}.get(conversion or "", lambda found: found)(value)
        return text.encode("ascii", "backslashreplace").decode("ascii") if conversion == "a" else text

    def format_field(self, value: Any, format_spec: str) -> str:
        """`format(value, format_spec)`."""
        return addressless_format(value, format_spec)


def format_method(budget: Budget, template: str, *arguments: object, **keywords: object) -> str:
    """`template.format(*arguments, **keywords)`."""
    return pay_for_text(budget, Fields().vformat(template, arguments, keywords))


def format_map_method(budget: Budget, template: str, mapping: Mapping[str, object]) -> str:
    """`template.format_map(mapping)`."""
    return pay_for_text(budget, Fields().vformat(template, (), mapping))


def pay_for_text(budget: Budget, text: Any) -> Any:
    """A text that was made."""
    refuse_too_long(len(text))
    budget.made(text)
    return text


def check_percent(template: str, values: object) -> None:
    """Refuse `template % values` where a width or precision, or a value, is too large. Raises `RunError`."""
    check_written(values)
    for parts in DIRECTIVE.findall(template):
        for part in parts:
            if part == "*":
                numbers = [as_whole_number(v) for v in (values if isinstance(values, tuple) else (values,)) if isinstance(v, int)]
                refuse_too_long(max(map(abs, numbers), default=0))
            elif part:
                check_specification(part)


def percent(template: str, values: object) -> str:
    """`template % values`."""
    check_percent(template, values)
    parts = values if isinstance(values, tuple) else values.values() if isinstance(values, dict) else (values,)
    text = template % (tuple(map(in_this_run, values)) if isinstance(values, tuple) else in_this_run(values))
    return text if all(isinstance(part, (str, int, float)) for part in parts) else without_addresses(text)


def join(budget: Budget, separator: Any, parts: Any) -> Any:
    """`separator.join(parts)`."""
    found = list(parts)
    refuse_too_long(container_length(separator) * len(found) + sum(map(container_length, found)))
    return pay_for_text(budget, separator.join(found))


def replace(budget: Budget, text: str, old: str, new: str, count: int = -1) -> str:
    """`text.replace(old, new, count)`."""
    found = str.count(text, old)
    count = as_whole_number(count)
    refuse_too_long(container_length(text) + (found if count < 0 else min(count, found)) * max(0, container_length(new) - container_length(old)))
    return pay_for_text(budget, text.replace(old, new, count))


def translate(budget: Budget, text: str, table: Any) -> str:
    """`text.translate(table)`."""
    if type(table) is not dict:
        raise TypeError("translate() takes a dictionary, as str.maketrans makes it")
    longest = max((container_length(v) for v in table.values() if isinstance(v, str)), default=1)
    refuse_too_long(len(text) * longest)
    return pay_for_text(budget, text.translate(table))


def expandtabs(budget: Budget, text: str, tabsize: int = 8) -> str:
    """`text.expandtabs(tabsize)`."""
    tabsize = as_whole_number(tabsize)
    refuse_too_long(len(text) + str.count(text, "\t") * max(0, tabsize))
    return pay_for_text(budget, text.expandtabs(tabsize))


def ljust(budget: Budget, text: str, width: int, *fill: str) -> str:
    """`text.ljust(width, fill)`."""
    refuse_too_long(width := as_whole_number(width))
    return pay_for_text(budget, text.ljust(width, *fill))


def rjust(budget: Budget, text: str, width: int, *fill: str) -> str:
    """`text.rjust(width, fill)`."""
    refuse_too_long(width := as_whole_number(width))
    return pay_for_text(budget, text.rjust(width, *fill))


def center(budget: Budget, text: str, width: int, *fill: str) -> str:
    """`text.center(width, fill)`."""
    refuse_too_long(width := as_whole_number(width))
    return pay_for_text(budget, text.center(width, *fill))


def zfill(budget: Budget, text: str, width: int) -> str:
    """`text.zfill(width)`."""
    refuse_too_long(width := as_whole_number(width))
    return pay_for_text(budget, text.zfill(width))


SLOW = ("rfind", "rindex", "rpartition", "rsplit", "strip", "lstrip", "rstrip")
"""Methods for which Python may compare each character of the text with each of the argument."""


def paid_text_method(name: str) -> Any:
    """A method of texts that pays for the characters that it compares."""
    method = getattr(str, name)

    def made(budget: Budget, text: str, *arguments: Any, **keywords: Any) -> object:
        budget.spend(
            container_length(text) * max([container_length(a) for a in (*arguments, *keywords.values()) if isinstance(a, str)], default=0) // 8
        )
        return method(text, *arguments, **keywords)

    return made


def paid_affix_test(name: str) -> Any:
    """`startswith` or `endswith`, which pays for each text that may begin or end it."""
    method = getattr(str, name)

    def made(budget: Budget, text: str, several: Any, *limits: Any) -> object:
        if isinstance(several, tuple):
            budget.spend(sum(map(container_length, several)))
        return method(text, several, *limits)

    return made


ENCODINGS = frozenset({"utf8", "utf16", "utf32", "ascii", "latin1", "iso88591", "cp1252"})


def check_encoding(name: Any) -> None:
    """Refuse an encoding that runs more than a few lines of C for each character. Raises `RunError`."""
    if not isinstance(name, str) or str.replace(str.lower(name), "-", "").replace("_", "") not in ENCODINGS:
        raise RunError("texts are encoded as utf-8, utf-16, utf-32, ascii, latin-1 or cp1252", rule="E-Call-Host")


def encode(budget: Budget, text: str, encoding: str = "utf-8", errors: str = "strict") -> bytes:
    """`text.encode(encoding, errors)`."""
    check_encoding(encoding)
    return pay_for_text(budget, str.encode(text, encoding, errors))


def decode(budget: Budget, data: bytes, encoding: str = "utf-8", errors: str = "strict") -> str:
    """`data.decode(encoding, errors)`."""
    check_encoding(encoding)
    return pay_for_text(budget, bytes.decode(data, encoding, errors))


METHODS = {
    **{name: paid_text_method(name) for name in SLOW}, "startswith": paid_affix_test("startswith"), "endswith": paid_affix_test("endswith"),
    "encode": encode,
    "format": format_method, "format_map": format_map_method, "join": join, "replace": replace, "translate": translate, "expandtabs": expandtabs,
    "ljust": ljust, "rjust": rjust, "center": center, "zfill": zfill,
}
"""The methods of `str` that are ours."""


ANYWHERE = re.compile(r" at 0x[0-9a-fA-F]+")
"""An address, wherever it stands."""


def stable_repr(value: object) -> str:
    """`repr(value)`, but never with an address in memory, which would differ from run to run, nor with thousands of digits or millions of parts."""
    try:
        check_written(value)
    except RunError:
        return f"{type(value).__name__} with too many parts to write"
    except RecursionError:
        return f"{type(value).__name__} nested too deeply to write, or without end"
    try:
        return ANYWHERE.sub("", repr(value))[:1000]
    except FuelExhausted:
        raise
    except ValueError:
        return f"{type(value).__name__} with a part, such as a long number, that is not written"
    except Exception:
        return f"{type(value).__name__} that does not say how it is written"
