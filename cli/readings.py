"""`scenic-ref readings`."""


def readings() -> None:
    """..."""
