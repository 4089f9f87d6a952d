"""What needs Pyro is imported when it is asked for."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

from ..interpreter.runtime.optional_packages import needed

if TYPE_CHECKING:
    from ..data.scene import Scene
    from ..inference.pyro_adapter import NumberModel, SceneKernel
    from ..semantics.kernel.config import Config


class ForPyro(NamedTuple):
    """What `inference.with_pyro` has."""

    kernel: type[SceneKernel]
    numbers: type[NumberModel]
    model: Callable[[Callable[[], Config], int], Callable[[], Scene | None]]


def pyro_for(what: str) -> ForPyro:
    """It, once Pyro is imported. Raises `UsageError` without the extra `pyro`: `what` needs it."""
    try:
        from ..inference.pyro_adapter import NumberModel, SceneKernel, model_of
    except ImportError as problem:
        raise needed(what, "pyro", problem) from None
    return ForPyro(SceneKernel, NumberModel, model_of)
