"""Loaded by every Python process that a test starts (it is first on PYTHONPATH): the process has the mutant too, or tells which lines it runs."""

import os
import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path


def beside(name):
    """A module of tests/mutants that needs no other of them."""
    spec = spec_from_file_location(f"mutants_{name}", Path(__file__).parents[1] / f"{name}.py")
    module = module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


if "SCENIC_REF_MUTANT" in os.environ:
    sys.meta_path.insert(0, beside("loading").Mutated.kept(os.environ["SCENIC_REF_MUTANT"]))
if "SCENIC_REF_LINES" in os.environ:
    beside("watching").watch_until_the_end(os.environ["SCENIC_REF_LINES"])
