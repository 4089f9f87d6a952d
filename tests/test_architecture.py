"""The shape of the package: layers, relative imports, what the wheel holds (DESIGN, section 2)."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import tomllib
import zipfile
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
LAYERS = [
    "semantics", "interpreter", "roads", "data", "pictures", "simulators", "inference", "api", "sampling", "testing", "conformance", "benchmarks",
    "editors", "playground", "cli",
]
BELOW = {"semantics", "interpreter", "roads", "data", "pictures"}
"""What reads programs and writes files; scenes know how they are drawn, and pictures what a scene is."""
MAY_IMPORT = {
    "semantics": {"semantics"},
    "interpreter": {"semantics", "interpreter"},
    "roads": {"semantics", "interpreter", "roads"},
    "data": BELOW,
    "pictures": BELOW,
    "simulators": {*BELOW, "simulators"} - {"pictures"},
    "inference": {*BELOW, "simulators", "inference"} - {"roads"},
    "api": {*BELOW, "simulators", "inference", "api"} - {"roads"},
    "conformance": {*BELOW, "simulators", "inference", "api", "testing", "conformance", ""} - {"roads"},
    "sampling": {*BELOW, "simulators", "inference", "api", "sampling"} - {"roads"},
    "testing": {"semantics", "interpreter", "data", "simulators", "inference", "api", "testing"},
    "benchmarks": {*BELOW, "simulators", "inference", "api", "benchmarks", ""} - {"roads", "data"},
    "editors": {"semantics", "interpreter", "simulators", "api", "editors", ""},
    "playground": {*LAYERS, ""} - {"testing", "conformance", "benchmarks"},
    "cli": {*LAYERS, ""},
}
ROOMS = ["syntax", "space", "store", "machine", "readings", "python", "scenes", "dynamics", ""]
"""Of `semantics`, the lowest first; "" are its tables: the step function, the catalogue of rules, programs."""
ONLY_IN = {
    "matplotlib": {
        "pictures/notebook_views.py", "data/scene.py", "api/scenario.py",
        "pictures/chain_plots.py", "pictures/side_by_side.py", "pictures/map_layers.py", "pictures/scene_figures.py", "pictures/map_figures.py",
        "pictures/movies.py",
        "benchmarks/bar_chart.py",
    },
    "PIL": {"pictures/movies.py"},
    "pygments": {"editors/pygments_lexer.py"}, "pyarrow": {"data/table_files.py", "api/scene_iterator.py"},
    "pandas": {"api/scene_iterator.py"}, "polars": {"api/scene_iterator.py"},
    "distributed": {"inference/batch/jobs/worker_pools.py"}, "hypothesis": {"conformance/generator/hypothesis_strategies.py"},
    "pymunk": {"simulators/pymunk_simulator.py"}, "sumo": {"simulators/sumo_simulator.py"}, "traci": {"simulators/sumo_simulator.py"},
    "starlette": {"playground/server.py"}, "uvicorn": {"playground/server.py"},
    "pygls": {"editors/server.py"}, "lsprotocol": {"editors/server.py"},
    "arviz": {"pictures/chain_plots.py"}, "pyro": {"inference/pyro_adapter.py"},
    "pyproj": {"roads/geodata.py"}, "shapefile": {"roads/geodata.py"},
    "torch": {
        "inference/pyro_adapter.py", *(f"inference/batch/torch_{n}.py" for n in ("lowering", "evaluator", "margins")),
        "inference/batch/primitives/torch_polygons.py"
    },
    **{name: {"inference/batch/primitives/numba_kernels.py", "inference/batch/code_cache.py"} for name in ("numba", "llvmlite")},
}

SEAM = {
    "space/box_crowds.py", "space/symbol_seam.py", "space/numeric_functions.py", "machine/sandbox_table.py", "machine/operand_kinds.py",
    "machine/values.py",
}
"""What of `semantics` knows that the batch backend answers draws by symbols."""
SCRIPTS = {"benchmarks/interpreter.py", "benchmarks/power.py", "benchmarks/pruning.py", "benchmarks/rare.py", "benchmarks/simulation.py"}
"""They are run by their paths, so that they import the package by its name."""


def modules() -> list[Path]:
    return [path for layer in LAYERS for path in sorted((ROOT / layer).rglob("*.py"))]


@cache
def imports(path: Path) -> list[tuple[int, str, ast.stmt]]:
    found = []
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom):
            found.append((node.level, node.module or "", node))
        elif isinstance(node, ast.Import):
            found += [(0, alias.name, node) for alias in node.names]
    return found


def test_imports_point_downwards_only():
    wrong = []
    for path in modules():
        parts = path.relative_to(ROOT).parts
        for level, module, node in imports(path):
            if level == 0:
                continue
            target = [*parts[:-1], *module.split(".")] if level == 1 else [*parts[: -level], *([m for m in module.split(".") if m])]
            layer = target[0] if target else ""
            if layer not in MAY_IMPORT[parts[0]]:
                wrong.append(f"{path.relative_to(ROOT)}:{node.lineno} imports {layer}")
    assert not wrong


def named(path: Path) -> str:
    """The dotted name of a module below the package."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


NAMES = {named(path): path for path in modules()}


def targets(path: Path, node: ast.ImportFrom) -> set[str]:
    """The modules of the package that a relative import names."""
    package = path.relative_to(ROOT).parts[:-1]
    base = ".".join([*package[: len(package) - node.level + 1], *([node.module] if node.module else [])])
    found = {f"{base}.{alias.name}" if f"{base}.{alias.name}" in NAMES else base for alias in node.names}
    return found & NAMES.keys()


def for_types_only(tree: ast.Module) -> set[ast.AST]:
    """Everything below `if TYPE_CHECKING`."""
    blocks = [n for n in tree.body if isinstance(n, ast.If) and isinstance(n.test, ast.Name) and n.test.id == "TYPE_CHECKING"]
    return {inner for block in blocks for inner in ast.walk(block)}


PAIRS = {
    ("semantics.space.regions.region", "semantics.space.regions.combinations"): "a region's methods make combinations, which are regions",
    ("cli.error_messages", "cli.run_report"): "a report shows source lines as errors do, and is slow to load",
}
"""Two files that know each other, one of them late, and why."""


def room(module: str) -> str:
    """The room of a module of `semantics`."""
    parts = module.split(".")
    return parts[1] if len(parts) > 1 and parts[1] in ROOMS else ""


def test_rooms_of_semantics_import_lower_ones_only():
    """Imports for types alone included."""
    wrong = []
    for name, path in NAMES.items():
        if name.startswith("semantics"):
            for node in ast.walk(ast.parse(path.read_text())):
                if isinstance(node, ast.ImportFrom) and node.level:
                    wrong += [f"{name} imports {t}" for t in targets(path, node) if ROOMS.index(room(t)) > ROOMS.index(room(name))]
    assert not wrong


def test_rules_do_not_meet_what_the_batch_backend_needs():
    """Values that stand for many scenes are behind one seam; no rule tells them from others, and no outcome speaks of them."""
    root = ROOT / "semantics"
    asked = re.compile(r"symbol_seam import|\b(Symbol|NotLifted|symbol_in)\b|\.always\(|\.lift\b")
    found = {str(path.relative_to(root)) for path in root.rglob("*.py") if asked.search(path.read_text())}
    assert found == SEAM | {"machine/host_calls.py"}  # the door, through which operations of Python are lifted


def test_modules_of_semantics_stand_in_a_room():
    assert {p.stem for p in (ROOT / "semantics").glob("*.py")} == {"__init__", "step", "rules", "theorems", "programs"}
    assert {p.name for p in (ROOT / "semantics").iterdir() if (p / "__init__.py").exists()} == set(ROOMS) - {""}


@pytest.mark.slow
def test_no_circle_of_imports_spans_more_than_two_files():
    """Those inside functions count, those for types do not, nor what a package's `__init__` gathers."""
    graph: dict[str, set[str]] = {}
    for name, path in NAMES.items():
        if path.name == "__init__.py":
            continue
        tree = ast.parse(path.read_text())
        typed = for_types_only(tree)
        nodes = [n for n in ast.walk(tree) if isinstance(n, ast.ImportFrom) and n.level and n not in typed]
        graph[name] = {t for n in nodes for t in targets(path, n)}
    large = [sorted(component) for component in components(graph) if len(component) > 2]
    assert not large


def components(graph: dict[str, set[str]]) -> list[set[str]]:
    """The strongly connected components."""
    reach: dict[str, set[str]] = {}
    for start in graph:
        seen: set[str] = set()
        pending = [start]
        while pending:
            for target in graph.get(pending.pop(), set()) - seen:
                seen.add(target)
                pending.append(target)
        reach[start] = seen
    return [{b for b in reach[a] if a in reach.get(b, set())} for a in graph if a in reach[a]]


@pytest.mark.slow
def test_imports_inside_functions_are_of_what_is_slow_to_load():
    """None hides a circle: what is imported late must not import, by whatever way, the module that imports it."""
    graph: dict[str, set[str]] = {}
    late: list[tuple[str, str]] = []
    for name, path in NAMES.items():
        tree = ast.parse(path.read_text())
        typed = for_types_only(tree)
        top = {n for n in tree.body if isinstance(n, ast.ImportFrom) and n.level}
        graph[name] = {t for n in top for t in targets(path, n)}
        every = [n for n in ast.walk(tree) if isinstance(n, ast.ImportFrom) and n.level and n not in typed and n not in top]
        late += [(name, t) for n in every for t in targets(path, n)]
    hidden = []
    for name, target in late:
        seen, pending = {target}, [target]
        while pending:
            for following in graph[pending.pop()] - seen:
                seen.add(following)
                pending.append(following)
        if name in seen and (name, target) not in PAIRS:
            hidden.append(f"{name} imports {target}")
    assert not hidden, "\n".join(hidden)


def test_imports_inside_the_package_are_relative():
    by_name = {str(p.relative_to(ROOT)) for p in modules() for level, module, _ in imports(p) if level == 0 and module.split(".")[0] == "scenic_ref"}
    assert by_name == SCRIPTS


@pytest.mark.slow
def test_scripts_are_imported_by_nobody():
    names = {script.removesuffix(".py").replace("/", ".") for script in SCRIPTS}
    assert not [str(p) for p in modules() for _, module, _ in imports(p) if f"{p.parent.name}.{module}" in names or module.endswith(tuple(names))]


@pytest.mark.slow
@pytest.mark.parametrize("script", sorted(SCRIPTS))
def test_scripts_can_be_run_by_their_paths(script):
    code = f"import sys; sys.path[0] = {str(ROOT / 'benchmarks')!r}; import {Path(script).stem}"
    assert subprocess.run([sys.executable, "-c", code], check=False, capture_output=True, text=True).returncode == 0


@pytest.mark.slow
@pytest.mark.parametrize("library", ONLY_IN)
def test_heavy_libraries_are_imported_in_one_place(library):
    users = {str(p.relative_to(ROOT)) for p in modules() for level, module, _ in imports(p) if level == 0 and module.split(".")[0] == library}
    assert users <= ONLY_IN[library]


def test_semantics_has_no_random_source_clock_or_files():
    forbidden = {"random", "time", "secrets", "os", "pathlib", "io", "sys", "subprocess", "datetime"}
    wrong = [
        f"{p.relative_to(ROOT)}: {module}"
        for p in (ROOT / "semantics").rglob("*.py")
        for level, module, _ in imports(p)
        if level == 0 and module.split(".")[0] in forbidden
    ]
    assert not wrong


def test_semantics_never_calls_numpy_random():
    wrong = [str(p) for p in (ROOT / "semantics").rglob("*.py") if "np.random" in p.read_text() or "global " in p.read_text().split('"""')[-1]]
    assert not wrong


def test_the_root_holds_the_public_api_only():
    assert {p.name for p in ROOT.glob("*.py")} == {"__init__.py", "__main__.py", "compat.py", "errors.py"}


def test_packages_in_pyproject_are_those_of_the_tree():
    listed = set(tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"])
    found = {"scenic_ref"} | {
        "scenic_ref." + ".".join(p.parent.relative_to(ROOT).parts) for layer in LAYERS for p in (ROOT / layer).rglob("__init__.py")
    }
    assert listed == found


@pytest.mark.slow
def test_the_wheel_holds_every_module_and_resource(tmp_path):
    subprocess.run(
        [sys.executable, "-m", "build", "--wheel", "--sdist", "--outdir", str(tmp_path), str(ROOT)], check=True, capture_output=True, text=True
    )
    names = set(zipfile.ZipFile(next(tmp_path.glob("*.whl"))).namelist())
    patterns = ("*.py", "*.lark", "*.scenic", "*.html", "*.css", "*.js", "*.toml")
    resources = [p for layer in LAYERS for pattern in patterns for p in (ROOT / layer).rglob(pattern)]
    resources = [p for p in resources if p.parent.name != "released"]  # the gallery in another syntax, which is in no wheel either
    missing = {f"scenic_ref/{p.relative_to(ROOT)}" for p in resources} - names
    assert not missing
    assert not {n for n in names if n.startswith(("scenic_ref/tests", "tests"))}


def test_help_loads_the_commands_and_nothing_that_does_their_work():
    """So that it takes some 0.15 s; no time is measured, since that of Python alone varies by half."""
    code = "import sys; sys.argv = ['scenic-ref', '--help']; from scenic_ref.cli.app import app; app(standalone_mode=False); print(*sys.modules)"
    shown, _, loaded = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout.rstrip("\n").rpartition("\n")
    ours = {name for name in loaded.split() if name.startswith("scenic_ref.") and not name.startswith("scenic_ref.cli.")}
    assert "simulate" in shown
    assert ours == {
        "scenic_ref.cli", "scenic_ref.interpreter", "scenic_ref.interpreter.runtime", "scenic_ref.interpreter.runtime.limits",
        "scenic_ref.interpreter.runtime.supervisor", "scenic_ref.sampling", "scenic_ref.sampling.program_source",
    }
    assert not {"numpy", "scipy", "shapely", "lark", "asyncio", "ctypes"} & set(loaded.split())


@pytest.mark.slow
def test_the_core_needs_none_of_the_extras():
    """Nor SciPy's statistics, more than a third of what was imported once; nor do commands that draw."""
    heavy = ("torch", "pyro", "pymunk", "pyarrow", "numba", "matplotlib", "scipy.stats")
    code = f"import sys, scenic_ref.api, scenic_ref.cli.run, scenic_ref.cli.simulation_run; print([m for m in {heavy} if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout.strip() == "[]"


def test_one_loop_drives_the_machine():
    """Others may do something besides a step, but none goes on to the next."""
    loops = []
    for path in modules():
        for loop in ast.walk(ast.parse(path.read_text())):
            if isinstance(loop, (ast.For, ast.While, ast.comprehension)):
                calls = [n.func for n in ast.walk(loop) if isinstance(n, ast.Call)]
                names = {f.id if isinstance(f, ast.Name) else f.attr if isinstance(f, ast.Attribute) else "" for f in calls}
                loops += [str(path.relative_to(ROOT))] if names & {"step", "machine"} else []
    assert set(loops) - TIME == {"semantics/machine/run_loop.py"}


TIME = {"simulators/pymunk_simulator.py", "testing/simulator_contract.py"}
"""Their loops go from one time step of a simulator to the next."""


@pytest.mark.slow
def test_a_class_name_means_one_thing():
    homes: dict[str, list[str]] = {}
    for path in modules():
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ClassDef):
                homes.setdefault(node.name, []).append(str(path.relative_to(ROOT)))
    assert len(homes) > 300
    assert not {name: places for name, places in homes.items() if len(places) > 1}


def test_links_lead_to_places_within_the_repository():
    links = [path for path in (ROOT / ".link").iterdir() if path.is_symlink()]
    assert [(path.name, str(path.readlink())) for path in links] == [("scenic_ref", "..")]


GLOSSARY = (ROOT / "docs" / "glossary.md").read_text()
PARTICIPLE = re.compile(r"(?:ing|ed)$")
IRREGULAR = {
    "begun", "built", "chosen", "done", "drawn", "driven", "found", "given", "held", "hidden", "kept", "known", "laid", "left", "made", "met",
    "put", "run", "said", "seen", "sent", "shown", "split", "spread", "stuck", "taken", "told", "written",
}  # fmt: skip
NOUNS = {"feed", "heading", "need", "seed", "speed", "string", "warning", "bearing"}


def ends_with_participle(name: str) -> bool:
    """Whether the last word of a name is a participle or a gerund."""
    last = name.rpartition("_")[2]
    return last not in NOUNS and (bool(PARTICIPLE.search(last)) or last in IRREGULAR)


def test_file_names_are_noun_phrases_but_for_the_terms_of_the_glossary():
    terms = set(re.findall(r"`(\w+)`", GLOSSARY.partition("## Participles")[2].partition("\n\n`released`")[0]))
    names = {path.parent.name if path.name == "__init__.py" else path.stem for path in modules()}
    assert {name for name in names if ends_with_participle(name)} - {"__init__"} == {
        name for name in names if name.rpartition("_")[2] in terms
    }
    assert terms <= {name.rpartition("_")[2] for name in names}


def test_a_name_of_a_function_means_one_thing():
    """A name of top-level functions in four modules or more is several things, but for `main` of programs."""
    found: dict[str, set[str]] = {}
    for path in modules():
        for node in ast.parse(path.read_text()).body:
            if isinstance(node, ast.FunctionDef):
                found.setdefault(node.name, set()).add(named(path))
    assert [name for name, places in found.items() if len(places) > 3] == ["main"]


def test_each_term_of_the_glossary_stands_there_once():
    terms = [line.split("|")[1].strip() for line in GLOSSARY.splitlines() if line.startswith("| ") and "---" not in line]
    terms = [term for term in terms if term != "term"]
    assert len(terms) > 40
    assert len(terms) == len(set(terms))


def test_docstrings_stand_alone():
    """None points at a neighbour, or says no more than the name."""
    command = [sys.executable, str(ROOT / "tools" / "structure_metrics.py"), "--list", "docstrings"]
    assert subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip() == ""
