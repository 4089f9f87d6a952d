"""The classes of errors (docs/errors.md): `from scenic_ref.errors import ParseError`."""

from .semantics.store.errors import *  # noqa: F403
