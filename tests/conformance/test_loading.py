"""The loader is strict: every fault of a vector file is a usage error that names the file and the vector."""

from __future__ import annotations

import pytest
from scenic_ref.conformance.vector_files import load_vectors, read_all, read_file
from scenic_ref.semantics.store.errors import UsageError

HEAD = 'chapter = "C"\n[[vector]]\nname = "v"\npaper = "p"\nprogram = "ego = Object"\n'
VALUES = "values = { params = { r = 1 }, tolerance = 0 }\n"
UNIT = "low = 0, high = 1"
LAW = f'distribution = {{ of = "ego.v", samples = 9, cdf = {{ name = "uniform", {UNIT} }}, rival.cdf = {{ name = "uniform", low = 0, high = 2 }} }}\n'
ONE = 'probabilities = { of = "params.r", outcomes = [{ value = 1, probability = "1" }], rival = ["1"], samples = 1 }'
CELL = f'support = {{ of = "ego.v", within.interval = {{ {UNIT} }}, reaches = [{{ interval = {{ {UNIT} }} }}], tolerance = 0, samples = 1 }}'


def test_a_minimal_file_is_read() -> None:
    (vector,) = read_file("f.toml", HEAD + VALUES)
    assert (vector.name, vector.chapter, vector.file, vector.kind, vector.texts) == ("v", "C", "f.toml", "values", {"paper": "ego = Object"})


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("chapter = 'C'\n", "the key vector is missing"),
        ("[[vector]]\nname = 'v'\n", "the key chapter is missing"),
        ("chapter = ", "Invalid value"),
        ("more = 1\n" + HEAD + VALUES, "there is no key more"),
        (HEAD, "exactly one matcher is needed, and there are 0: none"),
        (HEAD + VALUES + "error = { phase = 'run' }\n", "exactly one matcher is needed, and there are 2: values, error"),
        (HEAD + VALUES + "comment = 'x'\n", "there is no key comment"),
        (HEAD.replace('name = "v"\n', "") + VALUES, "vector 1: the key name is missing"),
        (HEAD.replace('paper = "p"\n', "") + VALUES, "the key paper is missing"),
        (HEAD.replace('program = "ego = Object"', "") + VALUES, "the key program is missing"),
        (HEAD + "fires = ['P-Nothing']\n" + VALUES, "fires: there is no rule P-Nothing"),
        (HEAD + "fires = 'P-At'\n" + VALUES, "fires must be a list of texts"),
        (HEAD + "avoids = ['P-Nothing']\n" + VALUES, "avoids: there is no rule P-Nothing"),
        (HEAD + "fires = ['P-At']\navoids = ['P-At']\n" + VALUES, "P-At both fires and must not fire"),
        (HEAD + "readings = { nothing = 'x' }\n" + VALUES, "there is no reading nothing"),
        (HEAD + "readings = { soft = 'x' }\n" + VALUES, "the reading soft has no alternative x"),
        (HEAD + "files = { '../a.scenic' = '' }\n" + VALUES, "'../a.scenic' is no path of a Scenic module"),
        (HEAD + "files = { 'a.py' = '' }\n" + VALUES, "'a.py' is no path of a Scenic module"),
        (HEAD + "files = { 'a.scenic' = 1 }\n" + VALUES, "a.scenic must be a text"),
        (HEAD + "dialects = ['klingon']\n" + VALUES, "there is no dialect klingon"),
        (HEAD + "dialects = []\n" + VALUES, "the program is given in no dialect"),
        (HEAD + "variants.klingon = 'x'\n" + VALUES, "there is no dialect klingon"),
        (HEAD + "variants.paper = 'x'\n" + VALUES, "the dialect paper has both the program and a variant"),
        (HEAD + "values = 3\n", "a table is expected, not 3"),
        (HEAD + "values = { tolerance = 0 }\n", "nothing is expected"),
        (HEAD + "values = { params = { r = 1 } }\n", "the key tolerance is missing"),
        (HEAD + "values = { params = { r = 1 }, tolerance = -1 }\n", "tolerance must not be negative"),
        (HEAD + "values = { params = { r = 1 }, tolerance = nan }\n", "tolerance must be a finite number"),
        (HEAD + "values = { params = { r = 1 }, tolerance = 0, scenes = 0 }\n", "scenes must be a whole number above 0"),
        (HEAD + "values = { objects = [{ index = -1, x = 1 }], tolerance = 0 }\n", "index must be a whole number from 0"),
        (HEAD + "values = { objects = [{ index = 0 }], tolerance = 0 }\n", "nothing is expected of the object"),
        (HEAD + "density = { runs = [] }\n", "runs must be a list with something in it"),
        (HEAD + "density = { runs = [{ draws = [1] }] }\n", "the key density is missing"),
        (HEAD + "density = { runs = [{ draws = [1], density = -1 }] }\n", "density must not be negative"),
        (HEAD + "density = { runs = [{ draws = [1], density = 1, value = 2 }] }\n", "there is no key value"),
        (HEAD + ONE.replace("params.r", "r"), "of must be a path"),
        (HEAD + ONE.replace("params.r", "params.r["), "of must be a path"),
        (HEAD + ONE.replace('probability = "1"', 'probability = "1/2"'), "add up to 1"),
        (HEAD + ONE.replace('["1"]', "[0.5, 0.5]"), "one for each"),
        (HEAD + ONE.replace('probability = "1"', 'probability = "a"'), "must be a fraction"),
        (HEAD + ONE.replace('probability = "1"', 'probability = "3/2"'), "a probability"),
        (HEAD + ONE.replace('[{ value = 1, probability = "1" }]', "[]"), "outcomes must be a list with something in it"),
        (HEAD + LAW.replace('cdf = { name = "uniform"', 'cdf = { name = "cauchy"', 1), "there is no distribution function 'cauchy'"),
        (HEAD + LAW.replace("low = 0, high = 1", "low = 1, high = 1", 1), "low must be below high"),
        (HEAD + LAW.replace("low = 0, high = 1", "low = 0, high = 1, mode = 3", 1), "there is no key mode"),
        (HEAD + LAW.replace("samples = 9", "samples = 9, moments = { mean = 0, low = 0, high = 1 }"), "either cdf or moments is needed"),
        (HEAD + LAW.split(", rival")[0] + " }\n", "the key rival is missing"),
        (HEAD + LAW.replace('"uniform", low = 0, high = 1', '"normal", mean = 0, deviation = 0', 1), "deviation must be above 0"),
        (HEAD + LAW.replace('"uniform", low = 0, high = 1', '"power", low = 0, high = 1, exponent = 0', 1), "exponent must be above 0"),
        (HEAD + LAW.replace('"uniform", low = 0, high = 1', '"triangular", low = 0, high = 1, mode = 2', 1), "mode must lie between"),
        (HEAD + LAW.replace('"uniform", low = 0, high = 1', '"piecewise-linear", knots = [[0, 0], [1, 0.5]]', 1), "the knots must rise"),
        (HEAD + LAW.replace('cdf = { name = "uniform", low = 0, high = 1 }', "moments = { mean = 2, low = 0, high = 1 }", 1), "the mean must lie"),
        (HEAD + CELL.replace("within.interval", "within.blob"), "no shape 'blob'"),
        (HEAD + CELL.replace("low = 0, high = 1", "low = 0", 1), "the key high is missing"),
        (HEAD + CELL.replace("reaches = [{ interval = { low = 0, high = 1 } }]", "reaches = []"), "reaches must be a list with something in it"),
        (HEAD + "rejection = { attempts = 3, requirement = 'mood' }\n", "there is no requirement 'mood'"),
        (HEAD + "error = { phase = 'later' }\n", "there is no phase 'later'"),
        (HEAD + "error = { phase = ['run', 'later'] }\n", "there is no phase 'later'"),
        (HEAD + "error = { phase = [] }\n", "phase must name one phase or more"),
        (HEAD + "error = { phase = 3 }\n", "phase must be a text or a list of texts, not 3"),
        (HEAD + "error = { phase = ['run', 3] }\n", "phase must be a text or a list of texts"),
        (HEAD + "error = { phase = 'run', class = 'Nonsense' }\n", "there is no error class Nonsense"),
        (HEAD + "error = { phase = 'run', rule = 'Nonsense' }\n", "there is no rule Nonsense"),
        (HEAD + "error = { phase = 'run', line = 0 }\n", "line must be a whole number above 0"),
    ],
)  # fmt: skip
def test_a_fault_of_a_file_is_named(text: str, message: str) -> None:
    with pytest.raises(UsageError) as caught:
        read_file("f.toml", text)
    assert message in caught.value.message
    assert caught.value.message.startswith("f.toml")


def test_a_name_may_be_used_once_only() -> None:
    with pytest.raises(UsageError, match=r"b.toml, vector v: this name is taken in a.toml"):
        read_all(iter([("a.toml", HEAD + VALUES), ("b.toml", HEAD + VALUES)]))


def test_the_vectors_of_the_package_are_read_in_the_order_of_their_files() -> None:
    files = [v.file for v in load_vectors()]
    assert files == sorted(files)
    assert len(set(files)) > 20
