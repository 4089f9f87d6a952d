"""Links that hold a program, a seed and readings."""

from __future__ import annotations

import base64
import zlib

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenic_ref.playground.share_links import LARGEST, MARK, Linked, is_link, link_of, linked_of
from scenic_ref.semantics.store.errors import UsageError


@given(st.builds(Linked, st.text(), st.integers(-(2**53), 2**53), st.dictionaries(st.text(), st.text())))
def test_a_link_holds_what_was_put_into_it(linked):
    assert linked_of(f"http://127.0.0.1:8642/#{link_of(linked)}") == linked_of(link_of(linked)) == linked


def packed(data: bytes) -> str:
    """A link to any bytes."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    return MARK + base64.urlsafe_b64encode(packer.compress(data) + packer.flush()).decode()


@pytest.mark.parametrize(
    "link",
    [
        MARK, MARK + "AAAA", MARK + "%%%", MARK + "é", packed(b"[]"), packed(b"{}"), packed(b'{"program": 1}'),
        packed(b'{"program": "", "seed": "1"}'),
        packed(b'{"program": "", "seed": true}'), packed(b'{"program": "", "readings": []}'), packed(b"[" * 10**5), packed(b"\xff"),
        packed(b'{"program": "' + b"x" * LARGEST + b'"}'), link_of(Linked("ego = Object", 0, {}))[:-4],
    ],
)  # fmt: skip
def test_what_is_no_link_is_told_so(link):
    with pytest.raises(UsageError, match="holds no program"):
        linked_of(link)


def test_a_file_is_no_link():
    assert not is_link("examples/two.scenic")
    assert not is_link("scenic1.scenic")
    assert is_link("http://127.0.0.1:1/#scenic1=abc")
