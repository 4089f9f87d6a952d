"""scenic_ref: the executable reference of the Scenic language.

    scenario = scenic_ref.load("scene.scenic")
    scene = scenario.sample(seed=0)
"""

from __future__ import annotations

from .interpreter.scenes import Scene, SceneObject
from .scenario import Scenario, load, loads
from .semantics import errors

__version__ = "0.1.0"

__all__ = ["Scenario", "Scene", "SceneObject", "__version__", "errors", "load", "loads"]
