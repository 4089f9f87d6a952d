"""scenic_ref: the executable reference of the Scenic language.

    scenario = scenic_ref.load("scene.scenic")
    scene = scenario.sample(seed=0)

The names below are loaded when they are first used, so that the command line answers at once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from . import errors
    from .api import Scenario, load, loads
    from .data.scene import Scene, SceneObject
    from .roads.geodata import save_map

__version__ = "0.1.0"

__all__ = ["Scenario", "Scene", "SceneObject", "__version__", "errors", "load", "loads", "save_map"]

_HOMES = {
    "Scene": ".data.scene", "SceneObject": ".data.scene", "Scenario": ".api", "load": ".api", "loads": ".api",
    "errors": ".errors", "save_map": ".roads.geodata",
}


def __dir__() -> list[str]:
    """The public names, those that are not loaded yet included."""
    return sorted({*globals(), *__all__})


def __getattr__(name: str) -> object:
    """A public name, from its home module (PEP 562)."""
    from importlib import import_module

    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module = import_module(_HOMES[name], __name__)
    return module if name == "errors" else getattr(module, name)
