"""Links that hold a program, a seed and readings: what stands behind the # of an address is never sent anywhere."""

from __future__ import annotations

import base64
import binascii
import json
import zlib
from typing import NamedTuple

from ..data.scene import in_json
from ..semantics.store.errors import UsageError

MARK = "scenic1="
"""What the part of an address behind # begins with."""
LARGEST = 1_000_000
"""Bytes that a link may hold, unpacked."""


class Linked(NamedTuple):
    """The content of a link."""

    program: str
    seed: int
    readings: dict[str, str]


def is_link(text: str) -> bool:
    """Whether a text is a link, or its part behind #."""
    return f"#{MARK}" in text or text.startswith(MARK)


def link_of(linked: Linked) -> str:
    """The part of a link behind #: JSON, deflated, in the letters of addresses."""
    data = in_json({"program": linked.program, "seed": linked.seed, "readings": linked.readings}).encode()
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    return MARK + base64.urlsafe_b64encode(packer.compress(data) + packer.flush()).decode().rstrip("=")


def linked_of(link: str) -> Linked:
    """Return the content of a link, or of its part behind #. Raises `UsageError`."""
    letters = link.partition(MARK)[2]
    try:
        packed = base64.b64decode(letters + "=" * (-len(letters) % 4), altchars=b"-_", validate=True)
        opener = zlib.decompressobj(-15)
        data = opener.decompress(packed, LARGEST)
        found = json.loads(data) if opener.eof else None
    except (binascii.Error, zlib.error, ValueError, RecursionError):
        found = None
    if not isinstance(found, dict):
        raise UsageError("this link holds no program", hint="was all of it copied?")
    program, seed, readings = found.get("program"), found.get("seed", 0), found.get("readings", {})
    if not isinstance(program, str) or type(seed) is not int or not isinstance(readings, dict):
        raise UsageError("this link holds no program", hint="was all of it copied?")
    return Linked(program, seed, {str(name): str(answer) for name, answer in readings.items()})
