"""The exception of a library for something that does not exist, where the run is to be rejected (the plain
forms of the driving library).
"""

from __future__ import annotations


class Absent(Exception):
    """There is no such thing: the run is stuck, as where a requirement is violated; the message says what there is not."""
