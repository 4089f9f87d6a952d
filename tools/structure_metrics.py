"""Compute the table of the code base's structure: modules, importers, circles of imports, names, lines and docstrings.

    python tools/structure_metrics.py [--list METRIC] [--json FILE]

`--list` prints what a metric counts, one finding a line. Everything is read from the sources, except `files_passed`, which parses and runs a
small program and looks at the stack of calls where `left of X by Y` becomes a node of the syntax tree, and where it becomes a value.
"""

from __future__ import annotations

import argparse
import ast
import json
import re
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
OUTSIDE = ("tests", "tools", "examples", ".ci")
IGNORE = re.compile(r"#\s*(?:type|pyright): ?ignore")
IRREGULAR = frozenset({
    "begun", "beaten", "bent", "bound", "bought", "broken", "brought", "built", "burnt", "caught", "chosen",
    "cut", "done", "drawn", "driven", "eaten", "fallen", "felt", "forbidden", "forgotten", "found", "given",
    "gone", "gotten", "grown", "heard", "held", "hidden", "kept", "known", "laid", "led", "left", "lost",
    "made", "meant", "met", "paid", "put", "read", "ridden", "risen", "run", "said", "seen", "sent", "set",
    "shown", "shut", "slid", "slain", "sought", "spelt", "spent", "split", "spoken", "spread", "stolen",
    "stood", "stuck", "sunk", "sworn", "taken", "taught", "thought", "thrown", "told", "torn", "understood",
    "unmet", "unsaid", "woken", "won", "worn", "woven", "wound", "written",
})  # fmt: skip
INNOCENT = frozenset(
    {"ceiling", "embed", "feed", "heading", "need", "seed", "speed", "string", "warning", "bearing"}
)
NEIGHBOUR = re.compile(r"(?:The same\b|As above|As there|That\b|What\b|Where\b|See\b|Likewise)")
LONGEST_LINE = 110
SHORTEST_DOCSTRING = 3
MANY_MODULES = 4


def tracked(pattern: str) -> list[Path]:
    """Return the files of the repository that match a pattern."""
    listed = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard", pattern],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    )
    return sorted(ROOT / line for line in listed.stdout.splitlines() if (ROOT / line).is_file())


def dotted_name(path: Path) -> str:
    """Return the name of a module below the package."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


class House:
    """The modules of the package with their syntax trees."""

    def __init__(self) -> None:
        self.sources = {p: p.read_text() for p in tracked("*.py")}
        self.modules = {
            dotted_name(p): p for p in self.sources if p.relative_to(ROOT).parts[0] not in OUTSIDE
        }
        self.trees = {name: ast.parse(self.sources[path]) for name, path in self.modules.items()}

    def place(self, name: str, node: ast.AST) -> str:
        """Return where a node of a module stands."""
        return f"{self.modules[name].relative_to(ROOT)}:{getattr(node, 'lineno', 1)}"

    def imported(self, name: str) -> Iterator[tuple[str, ast.ImportFrom]]:
        """Yield the modules of the package that a module imports, inside functions and for types too, with the statements."""
        path = self.modules[name]
        package = path.relative_to(ROOT).parts[:-1]
        for node in ast.walk(self.trees[name]):
            if not isinstance(node, ast.ImportFrom):
                continue
            module = node.module or ""
            if node.level:
                base = ".".join([*package[: len(package) - node.level + 1], *([module] if module else [])])
            elif module.split(".")[0] == "scenic_ref":
                base = module.partition(".")[2]
            else:
                continue
            for alias in node.names:
                inner = f"{base}.{alias.name}".strip(".")
                target = inner if inner in self.modules else base
                if target in self.modules and target != name:
                    yield target, node

    def top_functions(self) -> Iterator[tuple[str, ast.FunctionDef | ast.AsyncFunctionDef]]:
        """Yield the functions at the top of modules."""
        for name, tree in self.trees.items():
            yield from (
                (name, node)
                for node in tree.body
                if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))
            )


def single_importers(house: House) -> list[str]:
    """List the modules that one other module imports."""
    importers: dict[str, set[str]] = defaultdict(set)
    for name in house.modules:
        for target, _ in house.imported(name):
            importers[target].add(name)
    return [
        f"{t} <- {next(iter(who))}"
        for t, who in sorted(importers.items())
        if len(who) == 1 and house.modules[t].name != "__init__.py"
    ]


def participles(house: House) -> list[str]:
    """List the functions at the top of modules whose name is one word, a participle or gerund."""
    found = []
    for name, node in house.top_functions():
        word = node.name.strip("_")
        if word not in INNOCENT and (word in IRREGULAR or re.fullmatch(r"[a-z]{2,}(?:ed|ing)", word)):
            found.append(f"{house.place(name, node)} {node.name}")
    return found


def shared_names(house: House) -> list[str]:
    """List the names of top-level functions that occur in four or more modules."""
    homes: dict[str, list[str]] = defaultdict(list)
    for name, node in house.top_functions():
        homes[node.name].append(name)
    return [
        f"{name}: {', '.join(where)}" for name, where in sorted(homes.items()) if len(where) >= MANY_MODULES
    ]


def components(graph: dict[str, set[str]]) -> list[list[str]]:
    """Return the strongly connected components of more than one node (Tarjan)."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []

    def visit(node: str) -> None:
        index[node] = low[node] = len(index)
        stack.append(node)
        for target in graph.get(node, ()):
            if target not in index:
                visit(target)
                low[node] = min(low[node], low[target])
            elif target in stack:
                low[node] = min(low[node], index[target])
        if low[node] == index[node]:
            component = []
            while True:
                component.append(stack.pop())
                if component[-1] == node:
                    break
            if len(component) > 1:
                found.append(sorted(component))

    sys.setrecursionlimit(10_000)
    for node in graph:
        if node not in index:
            visit(node)
    return found


def circles(house: House) -> list[str]:
    """List the circles of imports, those for types among them; what a package's `__init__` gathers is not counted."""
    plain = {n for n, p in house.modules.items() if p.name != "__init__.py"}
    graph = {name: {t for t, _ in house.imported(name) if t in plain} for name in sorted(plain)}
    return [f"{len(c)}: {', '.join(c)}" for c in sorted(components(graph), key=len, reverse=True)]


def imports_of_semantics(house: House) -> list[str]:
    """List the statements of the command line that import from `semantics` anything but its errors."""
    statements = {}
    for name in house.modules:
        if name.split(".")[0] == "cli":
            for target, node in house.imported(name):
                if target.split(".")[0] == "semantics" and not target.endswith(".errors"):
                    statements[house.place(name, node)] = target
    return [f"{place} {target}" for place, target in statements.items()]


def long_lines(house: House) -> list[str]:
    """List the lines of more than 110 characters, those of tests too."""
    return [
        f"{path.relative_to(ROOT)}:{number}"
        for path, text in house.sources.items()
        for number, line in enumerate(text.splitlines(), 1)
        if len(line) > LONGEST_LINE
    ]


def ignore_comments(house: House) -> list[str]:
    """List the places outside tests where the type checker is told to look away."""
    paths = house.modules.values()
    return [
        f"{p.relative_to(ROOT)}:{k}"
        for p in paths
        for k, line in enumerate(house.sources[p].splitlines(), 1)
        for _ in IGNORE.findall(line)
    ]


def docstrings(house: House) -> Iterator[tuple[str, str]]:
    """Yield each docstring with its place."""
    for name, tree in house.trees.items():
        for node in ast.walk(tree):
            if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)) and (
                text := ast.get_docstring(node)
            ):
                yield house.place(name, node), text


def short_docstrings(house: House) -> list[str]:
    """List the docstrings of three words or fewer; a form of the language in backticks is no such docstring."""
    return [
        f"{place} {text}"
        for place, text in docstrings(house)
        if len(text.split()) <= SHORTEST_DOCSTRING and "`" not in text
    ]


def pointing_docstrings(house: House) -> list[str]:
    """List the docstrings that cannot be understood without a neighbour."""
    return [f"{place} {text.splitlines()[0]}" for place, text in docstrings(house) if NEIGHBOUR.match(text)]


def files_passed(_: House) -> list[str]:
    """List the files between the grammar and the value of `left of X by Y`: those on the stack where its node is built, and where it is evaluated."""
    code = Path(__file__).with_name("specifier_route.py")
    found = subprocess.run([sys.executable, code], check=True, capture_output=True, text=True, cwd=ROOT)
    return found.stdout.splitlines()


METRICS = {
    "modules outside tests": lambda house: [str(p.relative_to(ROOT)) for p in house.modules.values()],
    "modules with a single importer": single_importers,
    "one-word participles as function names": participles,
    "names of top-level functions in four or more modules": shared_names,
    "files between the grammar and the value of `left of X by Y`": files_passed,
    "circles of imports, types counted": circles,
    "statements in `cli` that import from `semantics`, errors aside": imports_of_semantics,
    "lines over 110 characters": long_lines,
    "`type: ignore`, `pyright: ignore`": ignore_comments,
    "docstrings of three words or fewer": short_docstrings,
    "docstrings that point at a neighbour": pointing_docstrings,
}


def main() -> None:
    """Print the table, or what one metric counts."""
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument(
        "--list", metavar="METRIC", help="print the findings of the metrics whose names contain this"
    )
    options.add_argument("--json", metavar="FILE", help="write the figures to a file")
    arguments = options.parse_args()
    house = House()
    figures = {}
    for name, metric in METRICS.items():
        if arguments.list is not None and arguments.list not in name:
            continue
        found = metric(house)
        figures[name] = len(found)
        if arguments.list is not None:
            print(*found, sep="\n")
        else:
            largest = f", the largest of {found[0].partition(':')[0]}" if metric is circles and found else ""
            print(f"| {name} | {len(found):,}{largest} |")
    if arguments.json:
        Path(arguments.json).write_text(json.dumps(figures, indent=1) + "\n")


if __name__ == "__main__":
    main()
