"""Lines that are parts of definitions, such as `compose:`, and how to write them."""

from __future__ import annotations

IN_SCENARIOS = "write `scenario Main():` with `setup:` and `compose:` blocks inside"
IN_HEADS = "write it in the first lines of one, before its other statements"
PARTS = {
    **dict.fromkeys(("setup", "compose"), ("a `scenario`", IN_SCENARIOS)),
    **dict.fromkeys(("precondition", "invariant"), ("a `behavior` or `scenario`", IN_HEADS)),
}
"""The words that such lines begin with: what they are parts of, and the hint where they stand elsewhere."""
