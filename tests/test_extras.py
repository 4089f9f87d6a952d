"""The optional packages: what works without each, and what is said by what does not."""

from __future__ import annotations

import importlib
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.data.table_files import open_table
from scenic_ref.inference import batch
from scenic_ref.inference.batch import block_rejection
from scenic_ref.interpreter.runtime.optional_packages import EXTRAS, is_installed
from scenic_ref.semantics.store.errors import UsageError
from scenic_ref.simulators import by_name

ROOT = Path(__file__).parent.parent
IMPORTED_AS = {"pyro-ppl": "pyro", "eclipse-sumo": "sumo", "pyshp": "shapefile"}
COMPILER = ("numba_evaluator", "numba_codegen", "numba_json", "code_cache", "primitives.numba_kernels")
"""The modules that need numba, below `inference.batch`."""


@pytest.fixture
def afresh(monkeypatch: pytest.MonkeyPatch) -> None:
    """What needs numba is imported anew."""
    for name in [n for n in sys.modules if n.split(".")[0] in ("numba", "llvmlite")] + [f"{batch.__name__}.{name}" for name in COMPILER]:
        monkeypatch.delitem(sys.modules, name, raising=False)
    for name in COMPILER:
        package, _, module = f".{name}".rpartition(".")
        monkeypatch.delattr(importlib.import_module(batch.__name__ + package), module, raising=False)


def test_the_table_of_extras_is_that_of_the_package():
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    packages = ((package.split(">")[0], name) for name in EXTRAS.values() for package in extras[name] if "[" not in package)
    ours = {IMPORTED_AS.get(package, package): name for package, name in packages}
    assert ours == EXTRAS
    assert set(extras) == {*EXTRAS.values(), "test", "style", "docs", "all"}


def test_without_numba_long_runs_are_drawn_on_columns(afresh, monkeypatch):
    monkeypatch.setitem(sys.modules, "numba", None)
    monkeypatch.setattr(block_rejection, "COMPILE_LEAST", -1e9)  # the compiled evaluator is wanted at once
    scenario = scenic_ref.load(ROOT / "examples" / "gallery" / "two_cars.scenic")
    assert len(list(scenario.sample_many(600, seed=3, backend="batch"))) == 600
    assert scenario.batch is not None
    assert not scenario.batch.compile()
    assert scenario.batch.not_compiled == "numba is not installed"
    assert not is_installed("numba")


def test_a_numba_that_does_not_fit_is_told_and_not_used(afresh, monkeypatch, tmp_path):
    (tmp_path / "numba").mkdir()
    (tmp_path / "numba" / "__init__.py").write_text("raise ImportError('Numba needs NumPy 1.0 or less')\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    batch = scenic_ref.loads("ego = Object at (Range(0, 1), 0)").batch
    assert batch is not None
    assert not batch.compile()
    assert batch.not_compiled == "numba cannot be imported (Numba needs NumPy 1.0 or less)"


def test_a_fault_of_ours_is_not_taken_for_a_missing_package(afresh, monkeypatch):
    monkeypatch.setitem(sys.modules, "scenic_ref.inference.batch.primitives.numba_kernels", None)
    batch = scenic_ref.loads("ego = Object at (Range(0, 1), 0)").batch
    assert batch is not None
    with pytest.raises(ImportError):
        batch.compile()


@pytest.mark.parametrize(
    ("package", "use"),
    [
        ("pymunk", lambda place: by_name("pymunk")), ("sumo", lambda place: by_name("sumo")),
        pytest.param("traci", lambda place: by_name("sumo"), marks=pytest.mark.extra("sumo")),
        ("pyarrow", lambda place: open_table(place / "x.parquet")),
        ("pyro", lambda place: scenic_ref.loads("ego = Object").pyro_model()), ("pyro", lambda place: scenic_ref.loads("ego = Object").pyro_kernel()),
        ("torch", lambda place: scenic_ref.loads("ego = Object").on_device("cpu")),
        ("torch", lambda place: scenic_ref.loads("ego = Object").margins()),
    ],
)  # fmt: skip
def test_what_needs_a_package_says_which_extra_has_it(package, use, monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, package, None)
    for name in [
        n
        for n in sys.modules if n.startswith(
            ("scenic_ref.inference.pyro_adapter", "scenic_ref.inference.batch.torch_", "scenic_ref.inference.batch.primitives.torch_")
        )
    ]:
        monkeypatch.delitem(sys.modules, name)
    with pytest.raises(UsageError, match=rf"needs the package {package}\nhint: pip install") as caught:
        use(tmp_path)
    assert f"scenic-ref[{EXTRAS[package]}]" in caught.value.hint
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("command", "package", "extra"), [("play", "starlette", "play"), ("play", "uvicorn", "play"), ("lsp", "pygls", "lsp")])
def test_servers_say_which_extra_they_need(command: str, package: str, extra: str) -> None:
    """In a process of its own, where nothing of the package is loaded yet."""
    code = f"import sys\nsys.modules[{package!r}] = None\nfrom scenic_ref.cli import run_command_line\nsys.exit(run_command_line([{command!r}]))"
    done = subprocess.run([sys.executable, "-c", code], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 2
    assert "needs the package " in done.stderr and f"pip install 'scenic-ref[{extra}]'" in done.stderr
