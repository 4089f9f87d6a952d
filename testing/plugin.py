"""The plugin for pytest: programs beside a test, and tests that are run for many scenes.

    def test_the_car_is_small(scenic):
        assert scenic("car.scenic").sample(seed=1).ego.width < 3

    @pytest.mark.scenic("crossing.scenic", scenes=20, seed=5)
    def test_nobody_is_in_the_way(scene):
        assert len(scene.objects) < 4

pytest loads this module wherever scenic-ref is installed: it imports nothing of the package before a test asks for it.
"""

from __future__ import annotations

import argparse
import ast
import json
import shlex
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import pytest

if TYPE_CHECKING:
    from ..api import Scenario
    from ..data.scene import Scene
    from ..semantics.store.errors import ScenicError
    from .failed_scenes import KeptScenes, SceneNumber

PACKAGE = Path(__file__).parent.parent
LOADED_BY = ("dialect", "profile", "readings", "params", "model", "trust", "fuel", "scenario")
"""What `scenic_ref.load` takes besides the path."""
DEFAULT_SCENES, DEFAULT_SEED = 10, 0
MOST_OBJECTS = 10
MARKER = (
    "scenic(program, scenes=10, seed=0, max_attempts=..., **options): run the test for so many scenes of the program, a file beside the test or a "
    "text; the fixture `scene` is the scene, and options are those of scenic_ref.load"
)
KEPT = pytest.StashKey["KeptScenes"]()
DRAWN, TRIED = pytest.StashKey["Scene"](), pytest.StashKey[bool]()
LOADED = pytest.StashKey["list[tuple[NamedProgram, Scenario]]"]()


class NamedProgram(NamedTuple):
    """A program as a test names it: a file, or a text of no file in a folder, with the options it is loaded with."""

    file: Path | None
    text: str
    folder: Path
    options: Mapping[str, object]

    def load(self) -> Scenario:
        """The scenario. Raises the program's error."""
        from ..api import load, loads

        if self.file is not None:
            return load(self.file, **self.options)  # type: ignore[arg-type]
        return loads(self.text, directory=self.folder, **self.options)  # type: ignore[arg-type]


class Marked(NamedTuple):
    """The settings from a test's markers: the program, the scenes, and the number of attempts after which to
    give up on one.
    """

    program: NamedProgram
    scenes: int
    seed: int
    attempts: int | None


def pytest_addoption(parser: pytest.Parser) -> None:
    """The options and the settings."""
    group = parser.getgroup("scenic", "tests that are run for many scenes")
    group.addoption("--scenic-scenes", type=positive, metavar="N", help="run tests for N scenes, whatever their markers say")
    group.addoption("--scenic-seed", type=int, metavar="SEED", help="the seed of the scenes, whatever the markers say")
    parser.addini("scenic_scenes", f"for how many scenes a test is run whose marker does not say ({DEFAULT_SCENES})", default=None)
    parser.addini("scenic_seed", f"the seed of the scenes of a test whose marker does not say ({DEFAULT_SEED})", default=None)


def positive(text: str) -> int:
    """A whole number from 1. Raises `argparse.ArgumentTypeError`."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"a whole number from 1 is expected, not {text!r}")
    return int(text)


def pytest_configure(config: pytest.Config) -> None:
    """The marker; what keeps scenes, in the process that hears of all tests."""
    config.addinivalue_line("markers", MARKER)
    if not hasattr(config, "workerinput"):
        from .failed_scenes import SceneKeeper

        config.pluginmanager.register(SceneKeeper(config), "scenic-scenes")


def kept_scenes(config: pytest.Config) -> KeptScenes:
    """The scenes that are kept from earlier runs, read once."""
    from .failed_scenes import KeptScenes

    if KEPT not in config.stash:
        config.stash[KEPT] = KeptScenes(config)
    return config.stash[KEPT]


# What a test asks for


def marker_settings(node: pytest.Item | pytest.Function, config: pytest.Config, path: Path) -> Marked | None:
    """Return the settings from the markers of a test, its class and its module, the nearest taking
    precedence; None without a marker. Raises `pytest.UsageError`.
    """
    markers = list(node.iter_markers("scenic"))
    if not markers:
        return None
    said: dict[str, object] = {}
    for marker in reversed(markers):
        said |= marker.kwargs
        if len(marker.args) > 1:
            raise pytest.UsageError("the marker scenic takes one program; whatever else it says has a name, as in scenes=20")
        said |= {"program": marker.args[0]} if marker.args else {}
    if "program" not in said:
        raise pytest.UsageError('the marker scenic needs a program, as in @pytest.mark.scenic("crossing.scenic", scenes=20)')
    program, attempts = said.pop("program"), said.pop("max_attempts", None)
    scenes = integer_setting("scenes", said.pop("scenes", None), config, DEFAULT_SCENES)
    seed = integer_setting("seed", said.pop("seed", None), config, DEFAULT_SEED)
    if scenes < 1:
        raise pytest.UsageError(f"scenes={scenes}: a test is run for at least one scene")
    if attempts is not None and (type(attempts) is not int or attempts < 1):
        raise pytest.UsageError(f"max_attempts={attempts!r}: a whole number from 1 is expected")
    return Marked(named_program(program, path.parent, said), scenes, seed, attempts)


def integer_setting(name: str, said: object, config: pytest.Config, otherwise: int) -> int:
    """A number of the marker: the command line wins over it, and it over the settings. Raises `pytest.UsageError`."""
    given = config.getoption(f"scenic_{name}")
    if given is not None:
        return given
    if said is None:
        said = config.getini(f"scenic_{name}")
        try:
            return otherwise if said is None else int(str(said))
        except ValueError:
            raise pytest.UsageError(f"scenic_{name} = {said}: a whole number is expected") from None
    if type(said) is not int:
        raise pytest.UsageError(f"{name}={said!r}: a whole number is expected")
    return said


def named_program(program: object, folder: Path, options: Mapping[str, object]) -> NamedProgram:
    """A program by the name of a file, or a text: one with a space or a line break that does not end in .scenic. Raises `pytest.UsageError`."""
    for name in options:
        if name not in LOADED_BY:
            raise pytest.UsageError(f"there is no option {name} of a program; there are {', '.join(LOADED_BY)}")
    if isinstance(program, str) and not program.endswith(".scenic") and len(program.split()) != 1:
        return NamedProgram(None, program, folder, options)
    if not isinstance(program, (str, Path)):
        raise pytest.UsageError(f"a program is the name of a file, or a text, not {program!r:.60}")
    return NamedProgram(folder / program, "", folder, options)


def checked_marker_settings(node: pytest.Item | pytest.Function, config: pytest.Config, path: Path) -> Marked | None:
    """Return the settings from the markers, after checking that the program's file exists. Raises
    `pytest.UsageError`.
    """
    found = marker_settings(node, config, path)
    if found is not None and found.program.file is not None and not found.program.file.is_file():
        from ..semantics.store.suggestions import nearest

        file = found.program.file
        near = nearest(file.name, [other.name for other in file.parent.glob("*.scenic")])
        raise pytest.UsageError(f"there is no file {shown_path(file, config)}" + (f"; did you mean {near}?" if near is not None else ""))
    return found


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """A test with the fixture `scene` and the marker is run for each scene, those first for which it failed the last time.

    One whose marker is wrong is run once, and told by `pytest_runtest_setup`: an error here would hide all other tests of the file.
    """
    if "scene" not in metafunc.fixturenames:
        return
    try:
        found = checked_marker_settings(metafunc.definition, metafunc.config, metafunc.definition.path)
    except pytest.UsageError:
        return
    if found is not None:
        from .failed_scenes import SceneNumber

        numbers = [*kept_scenes(metafunc.config).of(metafunc.definition.nodeid), *(SceneNumber(found.seed, n) for n in range(found.scenes))]
        numbers = list(dict.fromkeys(numbers))
        metafunc.parametrize("scene", numbers, indirect=True, ids=[str(number) for number in numbers])


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Tell of a test whose marker is wrong."""
    if "scene" in getattr(item, "fixturenames", ()):
        if scene_number(item) is None:
            wrong = ""
            try:
                checked_marker_settings(item, item.config, item.path)
            except pytest.UsageError as problem:
                wrong = str(problem)
            if wrong:  # outside of the handler, so that it is not told twice
                pytest.fail(f"the marker scenic of {item.name}: {wrong}", pytrace=False)
    elif any(marker.name == "scenic" for marker in item.own_markers):
        pytest.fail(f"{item.name} has the marker scenic, and must take the fixture `scene`: def {item.name}(scene)", pytrace=False)


# Fixtures


@pytest.fixture
def scenic(request: pytest.FixtureRequest) -> Callable[..., Scenario]:
    """Loads a program: the name of a file beside the test, or a text; keyword arguments are those of `scenic_ref.load`."""

    def load(program: str | Path, **options: object) -> Scenario:
        try:
            found = named_program(program, request.path.parent, options)
        except pytest.UsageError as problem:
            raise TypeError(str(problem)) from None
        return found.load()

    return load


@pytest.fixture
def scene(request: pytest.FixtureRequest) -> Scene:
    """One of the scenes that the marker asks for; the test is run for each."""
    found = marker_settings(request.node, request.config, request.path)
    number: SceneNumber | None = getattr(request, "param", None)
    if found is None or number is None:
        pytest.fail('the fixture `scene` needs the marker scenic, as in @pytest.mark.scenic("crossing.scenic", scenes=20)', pytrace=False)
    scenario = load_once(found.program, request.config)
    request.node.stash[TRIED] = True
    options = {} if found.attempts is None else {"max_attempts": found.attempts}
    request.node.stash[DRAWN] = scenario.sample(number.seed, number.number, **options)
    return request.node.stash[DRAWN]


def load_once(program: NamedProgram, config: pytest.Config) -> Scenario:
    """The scenario of a program, loaded and run once for all its scenes."""
    known = config.stash.setdefault(LOADED, [])
    for other, scenario in known:
        if other == program:
            return scenario
    scenario = program.load()
    scenario.rehearse()
    known.append((program, scenario))
    return scenario


# Reports


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[None]:
    """Tell of a failure which scene it was, how to draw it again, and where in the program an error is."""
    error = program_error(call)
    with nullcontext() if error is None else hide_own_frames(error):
        report: pytest.TestReport = yield  # pyright: ignore[reportAssignmentType]
    number = scene_number(item)
    if error is not None and report.failed:
        if call.when == "call":
            report.sections.append(("the program", error_report(error, hint=False)))  # pytest shows it with the error
        else:
            report.longrepr = error_report(error)
    if number is not None and call.when in ("setup", "call"):
        remember(item, number, report)
    return report  # pyright: ignore[reportReturnType]


@contextmanager
def hide_own_frames(error: BaseException) -> Iterator[None]:
    """Leave the lines of this package out of what pytest shows of an error, unless all are wanted (`--full-trace`)."""
    modules = [frame.f_globals for frame, _ in traceback.walk_tb(error.__traceback__) if Path(frame.f_code.co_filename).is_relative_to(PACKAGE)]
    for names in modules:
        names["__tracebackhide__"] = True
    yield
    for names in modules:
        names.pop("__tracebackhide__", None)


def program_error(call: pytest.CallInfo[None]) -> ScenicError | None:
    """The error of a program, or of how it was asked for, that ended a test."""
    errors = sys.modules.get(f"{(__package__ or '').partition('.')[0]}.semantics.store.errors")
    value: Any = None if call.excinfo is None else call.excinfo.value
    return value if errors is not None and isinstance(value, errors.ScenicError) else None


def error_report(error: ScenicError, *, hint: bool = True) -> str:
    """An error with its place in the program, the line there, and, unless it is shown already, the hint."""
    lines = [f"{error.kind}: {error.message}"]
    if error.span.line > 0:
        lines.append(f"  {error.span}: {source_line(error.span.file, error.span.line)}".rstrip(": "))
    return "\n".join([*lines, *([f"  hint: {error.hint}"] if hint and error.hint else []), *([f"  rule: {error.rule}"] if error.rule else [])])


def source_line(file: str, number: int) -> str:
    """A line of a file; \"\" where it cannot be read."""
    try:
        found = Path(file).read_text(encoding="utf-8").splitlines()
    except (OSError, ValueError):
        return ""
    return found[number - 1].strip()[:150] if number <= len(found) else ""


def scene_number(item: pytest.Item) -> SceneNumber | None:
    """Which scene a test is run for; None if it is none of ours."""
    params = getattr(getattr(item, "callspec", None), "params", {})
    found = params.get("scene") if isinstance(params, dict) else None
    return found if found is not None and type(found).__name__ == "SceneNumber" else None


def remember(item: pytest.Item, number: SceneNumber, report: pytest.TestReport) -> None:
    """Add to a report what is to be kept of its scene, and of a failure the scene for the reader."""
    from .failed_scenes import ATTRIBUTE

    found = marker_settings(item, item.config, item.path)
    if found is None or not item.stash.get(TRIED, False) or not (report.failed or (report.passed and report.when == "call")):
        return
    test = item.nodeid.removesuffix(f"[{getattr(item, 'callspec').id}]")  # noqa: B009 (of some items alone)
    drawn = item.stash.get(DRAWN, None)
    record = None if report.passed else record_of(found.program, drawn)
    setattr(report, ATTRIBUTE, json.dumps([test, *number, record]))
    if report.failed:
        where = kept_scenes(item.config).path(test, number)
        report.sections.append(("scene", "\n".join(describe_scene(found, number, drawn, where, item.config))))


def record_of(program: NamedProgram, drawn: Scene | None) -> dict[str, object]:
    """Return the data kept of a scene besides its number."""
    return {
        "program": None if program.file is None else str(program.file), "text": program.text or None,
        "options": {name: json_or_repr(value) for name, value in program.options.items()},
        "scene": None if drawn is None else json_or_repr(drawn.to_json()),
    }  # fmt: skip


def describe_scene(found: Marked, number: SceneNumber, drawn: Scene | None, where: Path | None, config: pytest.Config) -> list[str]:
    """A scene in a few lines, how to draw it again, and where it is kept."""
    program = found.program
    name = "the program of the test" if program.file is None else shown_path(program.file, config)
    lines = [f"{number} of {name}"]
    if drawn is not None:
        lines += [repr(drawn), *(f"  {one!r}" for one in drawn.objects[:MOST_OBJECTS])]
        lines += [f"  and {len(drawn.objects) - MOST_OBJECTS} more"] if len(drawn.objects) > MOST_OBJECTS else []
        lines += [f"  parameters {dict(drawn.params)!r:.500}"] if drawn.params else []
    lines.append(f"again: {again(program, number, found.attempts, config)}")
    return lines if where is None else [*lines, f"kept in {shown_path(where, config)}, and run first the next time"]


def json_or_repr(value: object) -> object:
    """A value as JSON has it; of what has no such form, its text."""
    if isinstance(value, Mapping):
        return {str(name): json_or_repr(one) for name, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [json_or_repr(one) for one in value]
    return value if value is None or type(value) in (bool, int, float, str) else repr(value)


def again(program: NamedProgram, number: SceneNumber, attempts: int | None, config: pytest.Config) -> str:
    """The command that draws a scene again; of a text, the call."""
    options = program.options
    if program.file is None:
        more = "".join(f", {name}={value!r}" for name, value in options.items())
        most = "" if attempts is None else f", max_attempts={attempts}"
        return f"scenic_ref.loads(...{more}).sample({number.seed}, {number.number}{most})"
    words = ["scenic-ref", "run", shown_path(program.file, config), "--seed", str(number.seed), "--scene", str(number.number)]
    for name in ("dialect", "profile", "model", "fuel", "scenario"):
        words += [f"--{name}", str(options[name])] if options.get(name) is not None else []
    words += [] if attempts is None else ["--max-attempts", str(attempts)]
    words += ["--trust"] if options.get("trust") else []
    for name, option in (("readings", "--reading"), ("params", "--param")):
        found = options.get(name)
        words += [word for key, value in (found.items() if isinstance(found, Mapping) else ()) for word in (option, f"{key}={argument(value)}")]
    return shlex.join(words)


def argument(value: object) -> str:
    """A value as `--param` reads it."""
    if not isinstance(value, str):
        return repr(value)
    try:
        ast.literal_eval(value)
    except (ValueError, SyntaxError):
        return value
    return repr(value)


def shown_path(path: Path, config: pytest.Config) -> str:
    """A path from where pytest was started, if it is below."""
    start = config.invocation_params.dir
    return str(path.relative_to(start)) if path.is_relative_to(start) else str(path)
