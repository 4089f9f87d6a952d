"""`scenic-ref rules`."""


def rules() -> None:
    """..."""
