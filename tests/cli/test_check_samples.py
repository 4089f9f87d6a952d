"""`scenic-ref check --samples`, and the same as an assertion: verdicts, exit codes, reports, formats, and what is refused."""

from __future__ import annotations

import inspect
import json
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
import scenic_ref
from scenic_ref.cli.check_reports import shares
from scenic_ref.inference.comparison.sample_files import read_samples
from scenic_ref.semantics.store.errors import UsageError
from scenic_ref.testing import assert_same_distribution

RIGHT = "x = Range(0, 1)\ny = Range(0, 1)\nego = Object at (x, 0)\nObject at (5, y), with requireVisible False\n"
WRONG = RIGHT.replace("y = Range(0, 1)", "y = x")
COIN = "ego = Object with v Uniform(1, 2)\n"


@pytest.fixture
def files(ask):
    for name, text in {"right": RIGHT, "wrong": WRONG, "coin": COIN}.items():
        Path(f"{name}.scenic").write_text(text)
        assert ask("run", f"{name}.scenic", "-n", 600, "--seed", 5, "-o", f"{name}.jsonl").code == 0
    return ask


def test_samples_of_the_program_are_inconclusive_or_equivalent_as_asked(files):
    found = files("check", "right.scenic", "--samples", "right.jsonl")
    assert found.code == 5
    assert found.out.startswith("inconclusive: no evidence of a difference")
    assert "replay: scenic-ref check right.scenic --samples right.jsonl --alpha 1e-09 --detect-tv 0.01 --seed 20190625" in found.out
    found = files("check", "right.scenic", "--samples", "right.jsonl", "--detect-tv", 0.6)
    assert (found.code, found.out.split(":")[0]) == (0, "equivalent within the stated power")
    found = files("check", "coin.scenic", "--samples", "coin.jsonl", "--detect-tv", 0.6, "--ignore", "*.v", "--ignore", "attempts")
    said = "equivalent: 600 scenes against the exact law, in which nothing that is compared varies on either side"
    assert (found.code, found.out.splitlines()[0]) == (0, said)


def test_samples_of_another_program_are_different_and_the_reports_say_where(files):
    found = files("check", "right.scenic", "--samples", "wrong.jsonl", "--report", "page.html", "--junit", "results.xml")
    assert found.code == 1
    assert "worst feature: objects[0].position[0] & objects[1].position[1]" in found.out
    page = Path("page.html").read_text()
    assert "objects[0].position[0] &amp; objects[1].position[1]" in page
    assert "<svg" in page and "http" not in page.replace("http://www.w3.org", "")
    first = page.partition("<svg")[2].partition("</svg>")[0]
    assert ">in m</text>" in first, "what the positions are measured in"
    assert re.search(r">0%</text>.*>\d+%</text>", first), "an axis of the shares"
    assert first.count("transform=") == first.count("<rect") / 2 > 3, "a label for each cell"
    suite = ElementTree.parse("results.xml").getroot()
    assert (suite.get("tests"), suite.get("failures"), suite.get("errors")) == ("1", "1", "0")
    assert suite.find("testcase/failure").get("type") == "different"


@pytest.mark.parametrize("highest", [1e-9, 0.012, 0.099, 0.1, 0.124, 0.19, 0.2, 0.501, 0.9, 1.0])
def test_the_axis_of_shares_has_a_few_round_steps(highest):
    axis = shares(highest)
    steps = [float(text) for text in re.findall(r">([\d.e-]+)%</text>", axis)]
    assert 2 <= len(steps) <= 6 and steps[0] == 0 and steps[-1] <= 100 * highest * (1 + 1e-9) < steps[-1] + steps[1]
    assert f"{steps[1]:.1e}".split("e")[0] in ("1.0", "2.0", "2.5", "5.0")


def test_the_replayed_command_says_the_same(files):
    first = files("check", "right.scenic", "--samples", "wrong.jsonl", "--reading", "soft=scene")
    command = first.out.splitlines()[-1].removeprefix("replay: scenic-ref ").split()
    assert files(*command) == first


def test_a_finite_program_is_compared_with_its_exact_law(files):
    found = files("check", "coin.scenic", "--samples", "coin.jsonl", "--detect-tv", 0.2)
    assert found.code == 0
    assert "600 scenes against the exact law" in found.out


def test_reference_scenes_can_be_given(files):
    files("run", "right.scenic", "-n", 600, "--seed", 6, "-o", "more.jsonl")
    assert files("check", "right.scenic", "--samples", "right.jsonl", "--reference", "more.jsonl").code == 5
    assert files("check", "right.scenic", "--samples", "wrong.jsonl", "--reference", "more.jsonl").code == 1


@pytest.mark.slow
def test_several_workers_give_the_same_verdict(files):
    alone = files("check", "right.scenic", "--samples", "right.jsonl")
    assert files("check", "right.scenic", "--samples", "right.jsonl", "--workers", 2).out == alone.out


@pytest.mark.slow
def test_samples_are_not_compared_with_themselves(files):
    found = files("check", "right.scenic", "--samples", "right.jsonl", "--seed", 5)
    assert found.code == 2
    assert "would be compared with themselves" in found.err


def test_a_value_that_cannot_be_is_different_however_rare(files):
    lines = Path("right.jsonl").read_text().splitlines()
    scene = json.loads(lines[321])
    scene["objects"][1]["width"] = 1.5
    Path("right.jsonl").write_text("\n".join([*lines[:321], json.dumps(scene), *lines[322:]]) + "\n")
    found = files("check", "right.scenic", "--samples", "right.jsonl")
    assert found.code == 1
    assert "objects[1].width is always 1, but 1.5 in sample 322" in found.out


def test_a_minimal_csv_is_enough(files):
    for name in ("right", "wrong"):
        scenes = [json.loads(line)["objects"] for line in Path(f"{name}.jsonl").read_text().splitlines()]
        rows = [f"{a['position'][0]},{b['position'][1]},{b['heading']}" for a, b in scenes]
        Path(f"{name}.csv").write_text("\n".join(["0.x,objects[1].position[1],1.heading", *rows]) + "\n")
    assert files("check", "right.scenic", "--samples", "right.csv").code == 5
    assert files("check", "right.scenic", "--samples", "wrong.csv").code == 1


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("s.jsonl", "{\n", "line 1: this is not JSON"),
        ("s.jsonl", '{"objects": 3}\n', "line 1: a scene has a list `objects`"),
        ("s.jsonl", '{"objects": [{"position": [1, "x"]}]}\n', "line 1: objects[0].position is not a pair of numbers"),
        ("s.jsonl", '{"objects": []},{"objects": []}\n', "line 1: this is not JSON"),
        ("s.jsonl", '{"objects": []}\n\n{"objects": []}{"objects": []}\n', "line 3: this is not JSON"),
        ("s.jsonl", '{"schema": "other/1", "objects": []}\n', "line 1: this is 'other/1', not a scene"),
        ("s.jsonl", '{"objects": [], "weight": 1}\n{"objects": [], "weight": 2}\n', "weighted scenes"),
        ("s.jsonl", '{"objects": [], "attempts": 0}\n', "line 1: `attempts` is not a whole number of at least 1"),
        ("s.csv", "0.x,0.y\n1,\n", "line 2: '' is not a value of objects[0].position[1]"),
        ("s.csv", "attempts\n-1\n", "line 2: -1 is not a value of attempts"),
        ("s.csv", "0.x,1.lenght\n1,2\n", "scenes of the program have no objects[1].properties.lenght"),
        ("s.csv", "7.x\n1\n", "scenes of the program have no objects[7].position[0]"),
        ("s.csv", "speed\n3\n", "'speed' names no feature"),
        ("s.csv", "0.x,0.y\n3\n", "line 2: 1 values, where the first line names 2"),
        ("s.csv", "0.x,objects[0].position[0]\n3,3\n", "two columns have the same name"),
    ],
)
def test_samples_in_no_format_are_refused_with_their_line(ask, name, text, message):
    Path(name).write_text(text)
    found = ask("check", "random.scenic", "--samples", name)
    assert found.code == 2
    assert message in found.err


@pytest.mark.parametrize(
    "options", [("--report", "page.txt"), ("--junit", "nowhere/r.xml"), ("--alpha", 0), ("--detect-tv", 1), ("--reference", "no.jsonl")]
)
def test_wrong_options_are_refused(files, options):
    assert files("check", "right.scenic", "--samples", "right.jsonl", *options).code == 2


def test_a_report_never_overwrites_what_is_read(files):
    Path("samples.xml").write_text(Path("right.jsonl").read_text())
    for option in ("--samples", "--reference"):
        given = {"--samples": "right.jsonl", option: "samples.xml"}
        found = files("check", "right.scenic", *(word for pair in given.items() for word in pair), "--junit", "samples.xml")
        assert (found.code, "samples.xml is the file of" in found.err) == (2, True)
        assert Path("samples.xml").read_text() == Path("right.jsonl").read_text()


def test_reports_belong_to_samples(ask):
    assert ask("check", "ok.scenic", "--report", "page.html").code == 2
    assert ask("check", "ok.scenic").out == "ok\n"


def test_the_assertion_shows_the_worst_feature_and_how_to_replay_it(files):
    scenario = scenic_ref.loads(RIGHT)
    assert assert_same_distribution("right.jsonl", scenario, detect_tv=0.6).kind == "equivalent"
    with pytest.raises(AssertionError) as caught:
        assert_same_distribution(read_samples("wrong.jsonl"), scenario)
    assert "worst feature: objects[0].position[0] & objects[1].position[1]" in str(caught.value)
    assert "replay: same_distribution(..., alpha=1e-09, detect_tv=0.01, seed=20190625), with the same samples" in str(caught.value)


def test_an_inconclusive_comparison_fails_unless_it_may_pass(files):
    scenario = scenic_ref.loads(RIGHT)
    with pytest.raises(AssertionError):
        assert_same_distribution("right.jsonl", scenario)
    assert assert_same_distribution("right.jsonl", scenario, inconclusive="pass").kind == "inconclusive"
    with pytest.raises(UsageError):
        assert_same_distribution("right.jsonl", scenario, inconclusive="maybe")


def test_the_command_has_the_defaults_of_the_functions():
    """They are written twice, so that `--help` need not load what they belong to."""
    from scenic_ref.cli import check, conformance, run
    from scenic_ref.conformance.implementations.protocol import SEED
    from scenic_ref.inference.comparison import DEFAULT_ALPHA, DEFAULT_TV
    from scenic_ref.inference.enumeration import DEFAULT_RUNS
    from scenic_ref.testing import REFERENCE_SEED

    defaults = {name: p.default for f in (check.check, conformance.conformance, run.run) for name, p in inspect.signature(f).parameters.items()}
    assert (defaults["alpha"], defaults["detect_tv"], defaults["max_runs"]) == (DEFAULT_ALPHA, DEFAULT_TV, DEFAULT_RUNS)
    assert (check.DEFAULT_SEED, inspect.signature(conformance.conformance).parameters["seed"].default) == (REFERENCE_SEED, SEED)
