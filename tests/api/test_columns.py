"""Scenes as columns: types depend on the values only, and pandas, Polars and DuckDB read what was written."""

from __future__ import annotations

import csv
import io
import json
import math
from pathlib import Path

import numpy as np
import pytest
import scenic_ref
from hypothesis import given, settings
from hypothesis import strategies as st
from scenic_ref.data import scene_tables, table_files, typed_columns
from scenic_ref.data.scene_tables import columns_of
from scenic_ref.data.table_files import ArrowStream, open_table
from scenic_ref.data.typed_columns import (
    FLOAT,
    INT53,
    INT64,
    JSON,
    NOTHING,
    TEXT,
    TypedColumn,
    as_kind,
    column_of,
    concatenate_columns,
    constant_column,
    empty_column,
    interleave_columns,
    json_text,
    vector_type,
)
from scenic_ref.inference.batch.jobs.block_tables import Tables
from scenic_ref.semantics.store.errors import AttemptsExhausted, UsageError

data = pytest.mark.extra("data")
PROGRAM = """
class Sign:
    word: Uniform('stop', 'yield')
class Van(Object):
    load: Range(0, 9)
    parts: [Range(0, 1), 2]
    mixed: Uniform(1, 'two')
    open: Uniform(True, False)
ego = Van at (1, 2)
Sign at (Range(5, 6), 9)
param wind = Range(0, 1), seats = DiscreteRange(1, 3), note = 'a "b", c'
"""
PROGRAM = PROGRAM.replace("class Sign:", "class Sign(Object):")
SCALARS = st.one_of(
    st.none(), st.booleans(), st.integers(-(2**70), 2**70), st.integers(-3, 3), st.floats(allow_nan=False, allow_infinity=False), st.text(max_size=3),
    st.sampled_from([{"repr": "inf"}, {"repr": "-inf"}, {"repr": "nan"}, {"repr": "x"}, -0.0, 2**53, 2**53 + 1]),
)
LISTS = st.lists(SCALARS, max_size=3) | st.lists(st.floats(-9, 9), min_size=2, max_size=2)
VALUES = SCALARS | LISTS | st.dictionaries(st.text(max_size=2), SCALARS, max_size=2)


def told(column: TypedColumn) -> list[str | None]:
    """The values of a column as JSON texts, None for those that are missing."""
    return [
        None if not there else (column.texts[k] if column.kind == JSON else json_text(column.texts[k]))
        for k, there in zip(column.values.tolist(), typed_columns.valid_in(column).tolist(), strict=True)
    ] if column.kind in (TEXT, JSON) else told(as_kind(column, JSON))


@pytest.mark.slow
@settings(deadline=None, derandomize=True, max_examples=400)
@given(st.lists(VALUES, min_size=1, max_size=8), st.data())
def test_the_type_of_a_column_and_its_values_do_not_depend_on_the_pieces(values, data):
    whole = column_of(values)
    cut = data.draw(st.integers(0, len(values)))
    again = data.draw(st.integers(0, cut))
    pieces = [column_of(part) for part in (values[:again], values[again:cut], values[cut:]) if part]
    parts = concatenate_columns([concatenate_columns(pieces[:2]), *pieces[2:]])
    assert parts.kind == whole.kind
    assert told(parts) == told(whole) == [None if v is None else json_text(v) for v in values]


def test_zeros_of_both_signs_stay_apart_whatever_the_pieces():
    assert told(
        concatenate_columns([column_of([0.0, -0.0, 0]), column_of(["x"])])
    ) == told(column_of([0.0, -0.0, 0, "x"])) == ["0", "-0.0", "0", '"x"']


@data
@pytest.mark.parametrize("suffix", table_files.SUFFIXES)
@pytest.mark.parametrize("backend", ["batch", "interpreter"])
def test_halves_of_characters_are_written_as_json_escapes_them(backend, suffix, tmp_path):
    scenario = scenic_ref.loads("ego = Object at (Range(0, 1), 0), with word Uniform('a\\ud800', 'b')\nparam '\\ud801' = 1\n")
    table = open_table(tmp_path / f"x{suffix}")
    for one in scenario.sample_many(20, backend=backend):
        table.add(one.to_json())
    table.finish()
    table.close()
    found = scenario.sample_many(20, backend=backend).to_arrow()
    assert {row["word"] for row in found["properties"].to_pylist()} == {'"a\\ud800"', '"b"'}
    assert found["params"].to_pylist()[0] == {"\\ud801": 1}


@settings(deadline=None, derandomize=True, max_examples=200)
@given(st.lists(st.tuples(VALUES, VALUES), min_size=1, max_size=5))
def test_columns_of_objects_become_rows(pairs):
    mixed = interleave_columns([column_of([a for a, _ in pairs]), column_of([b for _, b in pairs])])
    whole = column_of([value for pair in pairs for value in pair])
    assert (mixed.kind, told(mixed)) == (whole.kind, told(whole))


@settings(deadline=None, derandomize=True, max_examples=200)
@given(st.lists(VALUES, min_size=1, max_size=4), st.lists(st.integers(1, 3), min_size=4, max_size=4))
def test_a_column_of_one_value_is_a_column_like_others(values, counts):
    once = [constant_column(value, n) for value, n in zip(values, counts, strict=False)]
    each = [column_of([value] * n) for value, n in zip(values, counts, strict=False)]
    assert (concatenate_columns(once).kind, told(concatenate_columns(once))) == (concatenate_columns(each).kind, told(concatenate_columns(each)))
    once, each = [constant_column(value, 2) for value in values], [column_of([value] * 2) for value in values]
    assert (interleave_columns(once).kind, told(interleave_columns(once))) == (interleave_columns(each).kind, told(interleave_columns(each)))
    assert told(concatenate_columns([concatenate_columns(once), column_of([0.5])])) == told(
        concatenate_columns([concatenate_columns(each), column_of([0.5])])
    )


@pytest.mark.parametrize("suffix", [*(pytest.param(s, marks=data if s in (".parquet", ".arrow") else ()) for s in table_files.SUFFIXES)])
def test_a_file_is_the_same_whether_its_scenes_come_one_by_one_or_in_columns(suffix, small_groups, tmp_path):
    scenario = scenic_ref.loads(PROGRAM)
    for seed in range(4):
        one_by_one, in_columns = open_table(tmp_path / f"a{suffix}"), open_table(tmp_path / f"b{suffix}")
        for one in scenario.sample_many(30, seed):
            one_by_one.add(one.to_json())
        tables = Tables(scenario.batch.template)
        for start, stop in ((0, 1), (1, 8), (8, 30)):
            in_columns.add_columns(tables.of(scenario.batch.block(seed, start, stop), seed))
        for table in (one_by_one, in_columns):
            table.finish()
            table.close()
        assert one_by_one.path.read_bytes() == in_columns.path.read_bytes()


def test_values_that_are_alike_beside_missing_ones_stay_where_they_are(tmp_path):
    spool = table_files.Spool(tmp_path)
    first, second = interleave_columns([empty_column(2), constant_column(0, 2)]), column_of([None, 1.5, None, 0])
    for number, column in enumerate((first, second)):
        spool.write({**columns_of([scene(number)] * 4), "properties.p": column})
    assert [told(group["properties.p"]) for group in spool.read()] == [[None, "0", None, "0"], [None, "1.5", None, "0"]]
    spool.close()


def test_arrays_can_be_written_and_are_not_those_of_other_columns():
    found = scenic_ref.loads("x = Range(1, 2)\nego = Object at (x, 0), with foo x\nparam start = x\n").sample_columns(30)
    found["x"][0] = 7
    assert found["properties.foo"][0] == found["params.start"][0] != 7
    found = scenic_ref.loads(PROGRAM).sample_columns(30)
    for array in found.values():
        array[0] = array[1]
    found["width"][0] = 7
    assert found["width"].tolist()[:2] == [7, 1]


@pytest.mark.parametrize(
    ("values", "kind"),
    [
        ([1, 2], INT53), ([1, 2.5], FLOAT), ([1, None], INT53), ([None], NOTHING), ([True, False], "bool"), ([True, 1], JSON), (["a", None], TEXT),
        (["a", 1], JSON), ([[1, 2.0]], vector_type(2)), ([[1], [1, 2]], JSON), ([[]], JSON), ([2**60], INT64), ([2**60, 0.5], JSON), ([2**64], JSON),
        ([{"repr": "inf"}, 1.0], FLOAT), ([{"repr": "C"}], JSON), ([[1, "a"]], JSON), ([[2**53 + 1, 0]], JSON),
    ],
)
def test_the_type_of_values(values, kind):
    assert column_of(values).kind == kind


def test_numbers_that_turn_into_texts_are_the_same_whatever_they_were_before():
    mixed = concatenate_columns([column_of([3, 2**53]), column_of([0.5, -0.0, 1e300]), column_of(["x"])])
    assert told(mixed) == ["3", "9007199254740992", "0.5", "-0.0", "1e+300", '"x"']
    assert told(column_of([3, 3.0, "x"])) == ["3", "3", '"x"']


@pytest.mark.parametrize("backend", ["batch", "interpreter"])
def test_scenes_as_arrays(backend):
    scenario = scenic_ref.loads(PROGRAM)
    found = scenario.sample_many(40, backend=backend).columns()
    scenes = list(scenario.sample_many(40))
    vans, signs = slice(0, None, 2), slice(1, None, 2)
    assert found["x"][signs].tolist() == [s.objects[1].position[0] for s in scenes]
    assert found["properties.load"][vans].tolist() == [s.ego.properties["load"] for s in scenes]
    assert np.isnan(found["properties.load"][signs]).all()
    assert found["properties.parts"].shape == (80, 2)
    assert found["properties.word"][signs].tolist() == [s.objects[1].properties["word"] for s in scenes]
    assert set(found["properties.word"][vans]) == {None}
    assert isinstance(found["properties.open"], np.ma.MaskedArray)
    assert found["properties.open"][vans].tolist() == [s.ego.properties["open"] for s in scenes]
    assert set(found["properties.mixed"][vans]) == {"1", '"two"'}
    assert found["params.seats"].dtype == np.int64
    assert found["params.wind"][vans].tolist() == found["params.wind"][signs].tolist() == [s.params["wind"] for s in scenes]


def test_columns_are_those_of_the_scenes_that_are_left():
    drawn = scenic_ref.loads(PROGRAM).sample_many(30)
    assert next(drawn).index == 0
    assert sorted(set(drawn.columns()["scene"].tolist())) == list(range(1, 30))
    assert list(drawn) == []
    assert repr(drawn) == "<30 scenes, 30 of them drawn>"
    none = scenic_ref.loads(PROGRAM).sample_columns(0)
    assert none["x"].shape == (0,)
    assert [none[name].dtype.kind for name in ("x", "ego", "scene", "class")] == ["f", "b", "i", "O"]


def test_progress_is_told():
    for backend in ("batch", "interpreter"):
        seen: list[int] = []
        scenic_ref.loads(PROGRAM).sample_many(20, backend=backend, progress=seen.append).columns()
        assert seen == sorted(seen) and seen[-1] == 20
    with pytest.raises(UsageError, match="progress is True, False or a function"):  # a bar: below
        scenic_ref.loads(PROGRAM).sample_many(20, progress=3)  # type: ignore[arg-type]


@pytest.mark.parametrize("backend", ["batch", "interpreter"])
def test_a_bar_is_shown_and_stops_however_the_drawing_ends(backend, capsys):
    whole = scenic_ref.loads(PROGRAM).sample_many(20, backend=backend, progress=True)
    next(whole)
    assert whole._tell.shown.live.is_started
    whole.columns()
    rare = scenic_ref.loads("ego = Object at (Range(0, 1), 0)\nrequire ego.position.x < 0.1\n")
    failing = rare.sample_many(50, 1, backend=backend, max_attempts=12, progress=True)
    with pytest.raises(AttemptsExhausted):
        failing.columns()
    left = scenic_ref.loads(PROGRAM).sample_many(20, backend=backend, progress=True)
    next(left)
    bar = left._tell
    del left
    assert not any(one.shown.live.is_started for one in (whole._tell, failing._tell, bar))
    assert "100%" in capsys.readouterr().err


def scene(number: int, **properties: object) -> dict[str, object]:
    """A scene of one object, in the scene format."""
    one = {"id": 0, "name": None, "class": "Object", "position": [0.0, 1.0], "heading": 0.0, "width": 1.0, "length": 1.0, "properties": properties}
    return {"seed": 0, "scene": number, "attempts": 1, "weight": 1.0, "ego": 0, "params": {}, "objects": [one]}


WIDENING = [scene(k, a=k, b=k) for k in range(20)] + [scene(20, a=0.5)] + [scene(k, a=1, b="x", c=[1, 2]) for k in range(21, 30)]
WIDE = {"a": [*range(20), 0.5, *[1.0] * 9], "b": [*map(str, range(20)), None, *['"x"'] * 9], "c": [None] * 21 + [[1.0, 2.0]] * 9}


@pytest.fixture
def small_groups(monkeypatch):
    monkeypatch.setattr(scene_tables, "ROWS_AT_ONCE", 4)


@data
@pytest.mark.parametrize("suffix", [".parquet", ".arrow"])
@pytest.mark.parametrize("at_once", [1, 7, 1000])
def test_types_are_those_of_all_scenes_though_they_come_in_groups(suffix, at_once, small_groups, tmp_path, monkeypatch):
    import polars

    monkeypatch.setattr(scene_tables, "SCENES_AT_ONCE", at_once)
    table = open_table(tmp_path / f"x{suffix}")
    for one in WIDENING:
        table.add(one)
    table.finish()
    table.close()
    read = polars.read_parquet(tmp_path / "x.parquet") if suffix == ".parquet" else polars.read_ipc(tmp_path / "x.arrow")
    assert {name: [v if not isinstance(v, polars.Series) else v.to_list() for v in read["properties"].struct.field(name)] for name in "abc"} == WIDE


@data
@pytest.mark.parametrize("suffix", ["parquet", "arrow"])
def test_pandas_polars_and_duckdb_read_a_table(suffix, tmp_path, monkeypatch):
    import duckdb
    import pandas
    import polars
    from pyarrow import feather, parquet

    path = tmp_path / f"x.{suffix}"
    scenario = scenic_ref.loads(PROGRAM)
    table = open_table(path)
    for one in scenario.sample_many(50):
        table.add(one.to_json())
    table.finish()
    table.close()
    loads = [s.ego.properties["load"] for s in scenario.sample_many(50)]
    frame = pandas.read_parquet(path) if suffix == "parquet" else pandas.read_feather(path)
    assert [p["load"] for p in frame["properties"]][::2] == loads
    other = polars.read_parquet(path) if suffix == "parquet" else polars.read_ipc(path)
    assert other["properties"].struct.field("load").to_list()[::2] == loads
    whole = parquet.read_table(path) if suffix == "parquet" else feather.read_table(path)
    where = f"'{path}'" if suffix == "parquet" else "whole"
    found = duckdb.sql(f"select properties.load, params.note, properties.parts[1] from {where} where class = 'Van' order by scene").fetchall()
    assert [row[0] for row in found] == loads
    assert {row[1] for row in found} == {'a "b", c'}
    assert whole.schema.metadata[b"schema"] == b"scenic-ref/table/2"


@data
def test_frames_of_what_is_drawn():
    scenario = scenic_ref.loads(PROGRAM)
    found = scenario.sample_columns(30)
    frame = scenario.sample_many(30).to_pandas()
    assert frame["params.wind"].tolist() == found["params.wind"].tolist()
    assert frame["properties.open"].isna().sum() == 30
    assert frame["properties.parts"][0] == found["properties.parts"][0].tolist()
    assert frame["class"].dtype == "category"
    assert scenario.sample_many(30).to_polars()["x"].to_list() == found["x"].tolist()
    assert scenario.sample_many(0).to_arrow().num_rows == 0


@pytest.mark.parametrize("n", [3, 30])
def test_scenes_that_are_all_taken_have_no_columns_but_those_of_none_do(n):
    scenario = scenic_ref.loads(PROGRAM)
    drawn = scenario.sample_many(n)
    next(drawn)
    assert len(set(drawn.columns()["scene"].tolist())) == n - 1, "those that are left"
    for taken in (drawn, scenario.sample_many(n)):
        list(taken)
        with pytest.raises(UsageError, match="all of these scenes are taken"):
            taken.columns()
    assert len(scenario.sample_many(0).columns()["x"]) == 0


@pytest.mark.parametrize(("method", "package"), [("to_arrow", "pyarrow"), ("to_pandas", "pandas"), ("to_polars", "polars")])
def test_a_missing_package_is_named_with_its_extra(method, package, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, package, None)
    with pytest.raises(UsageError, match=package) as found:
        getattr(scenic_ref.loads(PROGRAM).sample_many(2), method)()
    assert found.value.hint is not None
    assert "pip install 'scenic-ref[" in found.value.hint


@data
def test_a_stream_has_the_types_of_its_beginning(small_groups):
    from pyarrow import ipc

    target = io.BytesIO()
    stream = ArrowStream(target)
    stream.add_columns(columns_of(WIDENING[:20]))
    stream.finish()
    read = ipc.open_stream(target.getvalue()).read_all()
    assert [p["a"] for p in read["properties"].to_pylist()] == list(range(20))
    stream = ArrowStream(io.BytesIO())
    with pytest.raises(UsageError, match=r"properties.a is float64 in scene 20 or later, and int64 before"):
        for one in WIDENING:
            stream.add_columns(columns_of([one]))
    empty = io.BytesIO()
    stream = ArrowStream(empty)
    stream.finish()
    assert ipc.open_stream(empty.getvalue()).read_all().num_rows == 0


def test_a_table_of_commas_and_quotes(tmp_path):
    table = open_table(tmp_path / "x.csv")
    for one in scenic_ref.loads(PROGRAM).sample_many(20):
        table.add(one.to_json())
    table.finish()
    table.close()
    rows = list(csv.DictReader(io.StringIO(Path(tmp_path / "x.csv").read_text("utf-8"), newline="")))
    scenes = list(scenic_ref.loads(PROGRAM).sample_many(20))
    assert [float(row["properties.load"]) for row in rows[::2]] == [s.ego.properties["load"] for s in scenes]
    assert {row["properties.load"] for row in rows[1::2]} == {""}
    assert {row["params.note"] for row in rows} == {'a "b", c'}
    assert json.loads(rows[0]["properties.parts"])[1] == 2
    assert math.isclose(float(rows[1]["y"]), 9)


def test_a_few_scenes_that_need_many_attempts_are_those_of_both_backends():
    scenario = scenic_ref.loads("x = Range(0, 1)\nego = Object at (x, 0)\nrequire x > 0.998\n")
    found = [s.to_line() for s in scenario.sample_many(5, 5)]
    assert found == [s.to_line() for s in scenario.sample_many(5, 5, backend="batch")]
    assert scenario.sample(5, 2).to_line() == found[2]
    assert [json.loads(line)["attempts"] for line in found][1:3] == [67, 1381], "the interpreter finds the second one, the batch backend the third"


def test_that_none_of_a_few_scenes_is_possible_is_said_soon():
    drawn = scenic_ref.loads("x = Range(0, 1)\nego = Object at (x, 0)\nrequire x > 2\n").sample_many(3)
    with pytest.raises(AttemptsExhausted, match="no scene is possible: the requirement on line 3 fails, whatever is drawn"):
        list(drawn)
    with pytest.raises(AttemptsExhausted, match="no scene in 20 attempts"):
        list(scenic_ref.loads("x = Range(0, 1)\nego = Object at (x, 0)\nrequire x > 2\n").sample_many(3, max_attempts=20))


@pytest.mark.extra("parquet")
def test_parquet_compresses_what_can_be_smaller(tmp_path):
    from pyarrow import parquet

    program = "x = Range(0, 1)\nego = Object at (x, 0), with few Uniform(1.5, 2.5), with whole DiscreteRange(0, 99999), with pair (x, x)\n"
    table = open_table(tmp_path / "x.parquet")
    scenes = list(scenic_ref.loads(program).sample_many(1100))
    for one in scenes:
        table.add(one.to_json())
    table.finish()
    group = parquet.ParquetFile(tmp_path / "x.parquet").metadata.row_group(0)
    found = {group.column(i).path_in_schema: group.column(i) for i in range(group.num_columns)}
    assert {name for name, column in found.items() if column.compression != "ZSTD"} == {"x"}
    assert "DELTA_BINARY_PACKED" in found["scene"].encodings
    few = {name for name, column in found.items() if "RLE_DICTIONARY" in column.encodings}
    assert {"seed", "class", "y", "properties.few"} <= few
    assert not {"scene", "x", "properties.whole", "properties.pair.list.element"} & few
    assert parquet.read_table(tmp_path / "x.parquet")["x"].to_pylist() == [one.ego.position.x for one in scenes]
