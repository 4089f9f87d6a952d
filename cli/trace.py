"""`scenic-ref trace`."""


def trace() -> None:
    """..."""
