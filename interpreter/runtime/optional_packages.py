"""The optional packages: the extra that installs each, whether it is installed, and the error if it is not.

Each is imported in one place, lazily, by whoever needs it; all else works without.
"""

from __future__ import annotations

import importlib.util
import sys

from ...semantics.store.errors import UsageError

EXTRAS = {
    "numba": "fast", "orjson": "fast", "pyarrow": "parquet", "distributed": "cluster", "pymunk": "dynamics", "pyro": "pyro", "torch": "torch",
    "arviz": "arviz", "sumo": "sumo", "traci": "sumo", "pandas": "data", "polars": "data", "pyproj": "geo", "shapefile": "geo",
    "starlette": "play", "uvicorn": "play", "pygls": "lsp",
}
"""The extra of each optional package."""


def is_installed(package: str) -> bool:
    """Whether an optional package can be imported, as far as can be told without doing so."""
    if package in sys.modules:
        return sys.modules[package] is not None
    return importlib.util.find_spec(package) is not None


def why_missing(package: str, problem: ImportError) -> str:
    """Return the reason why an optional package cannot be imported: it is not installed, or it does not fit
    the others. Raises a fault of ours.
    """
    if problem.name is not None and problem.name.split(".")[0] == "scenic_ref":
        raise problem
    return f"{package} cannot be imported ({problem})" if is_installed(package) else f"{package} is not installed"


def missing_package_error(what: str, package: str, problem: ImportError, otherwise: str = "") -> UsageError:
    """The error that `what` needs a package whose import failed; `otherwise` is what one can do without it."""
    found = why_missing(package, problem)
    text = f"{what} needs the package {package}" + ("" if found.endswith("not installed") else f": {found}")
    return UsageError(text, hint=f"pip install 'scenic-ref[{EXTRAS[package]}]'{otherwise}")
