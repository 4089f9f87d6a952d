"""Lines on their way to a file: whole ones, few at a time, however long they are."""

from __future__ import annotations

import pytest
from scenic_ref.cli.scene_outputs import AT_ONCE, in_pieces

SHORT, LONG = b"x" * 99 + b"\n", b"y" * (3 * AT_ONCE) + b"\n"


@pytest.mark.parametrize("lines", [[SHORT] * 5000, [LONG] * 3, [SHORT, LONG, SHORT, LONG], [b"\n"], []], ids=["short", "long", "both", "one", "none"])
@pytest.mark.parametrize("kind", [bytes, memoryview])
def test_pieces_are_whole_lines_and_no_longer_than_they_must_be(lines: list[bytes], kind: type) -> None:
    text = b"".join(lines)
    pieces = [bytes(piece) for piece in in_pieces([kind(text)], AT_ONCE)]
    assert b"".join(pieces) == text
    assert all(piece.endswith(b"\n") and len(piece) <= max(AT_ONCE, 2 * len(LONG)) for piece in pieces)
    assert all(len(piece) <= AT_ONCE for piece in pieces if LONG not in piece)


def test_what_ends_without_a_line_end_is_given_as_it_is() -> None:
    assert [bytes(piece) for piece in in_pieces([b"a\nbc", b"d"], AT_ONCE)] == [b"a\n", b"bc", b"d"]
