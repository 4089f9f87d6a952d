"""For the tests of other implementations: were these scenes drawn from the distribution of that scenario?

    from scenic_ref.testing import assert_same_distribution

    def test_my_sampler():
        scenes = [my_sampler.scene() for _ in range(5000)]          # in the scene format
        assert_same_distribution(scenes, scenic_ref.load("scene.scenic"), detect_tv=0.15)

The names below are loaded when they are first used: pytest loads `plugin` wherever this package is installed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .judge import REFERENCE_SEED, assert_same_distribution, same_distribution
    from .simulator_contract import BrokenContract, check_simulator

__all__ = ["REFERENCE_SEED", "BrokenContract", "assert_same_distribution", "check_simulator", "same_distribution"]


def __getattr__(name: str) -> object:
    """A public name, from its home module (PEP 562)."""
    from importlib import import_module

    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    home = ".simulator_contract" if name in ("BrokenContract", "check_simulator") else ".judge"
    return getattr(import_module(home, __name__), name)
