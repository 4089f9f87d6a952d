"""The server of the playground: who is answered, what each work answers, and what a program cannot do to it."""

from __future__ import annotations

import http.client
import json
import os
import re
import select
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from urllib.parse import urlsplit

import pytest
import scenic_ref
from scenic_ref.cli import run_command_line
from scenic_ref.playground.json_views import IN_PAGE

pytestmark = pytest.mark.extra("play")
posix = pytest.mark.skipif(sys.platform == "win32", reason="this system has no signals")
ROOT = Path(__file__).parents[2]
PLAIN = "ego = Object at (0, 0)\nother = Object at (Range(3, 5), 5)\nparam x = other.position.x\n"
FINITE = "x = Uniform(1, 2, 3)\nego = Object at (0, 0)\nother = Object at (5 * x, 5)\nrequire x < 3\nparam x = x\n"
ENDLESS = "while True:\n    pass\nego = Object at (0, 0)\n"
SLOW = "x = Range(0, 1)\nego = Object at (0, 0)\nfor i in range(100):\n    y = [j for j in range(200)]\nrequire x > 2\n"


@pytest.fixture(params=["/", "/wrong/", "/wrong/work", "/favicon.ico", "/é/"])
def elsewhere(request: pytest.FixtureRequest) -> str:
    """A path without the token."""
    return request.param.encode().decode("latin-1")


# Who is answered


def test_the_address_is_on_the_loopback_interface_and_has_a_long_token(served):
    assert re.fullmatch(r"http://127\.0\.0\.1:\d+/[\w-]{43}/", served.address)


@pytest.mark.parametrize("method", ["GET", "POST", "DELETE", "OPTIONS"])
def test_without_the_token_there_is_nothing(served, elsewhere, method):
    path = "".join(c if ord(c) < 128 else f"%{ord(c):02X}" for c in elsewhere)
    found = served.request(method, path)
    assert found.status == 403
    assert served.path.strip("/") not in found.body
    assert "token" in found.body
    assert "ego" not in found.body


def test_the_page_is_for_who_has_the_token(served):
    found = served.request("GET", served.path)
    assert found.status == 200
    assert "<textarea" in found.body


@pytest.mark.parametrize("host", ["evil.example", "evil.example:80", "127.0.0.1", "127.0.0.1.evil.example", ""])
@pytest.mark.parametrize("path", ["", "work"])
def test_another_name_for_the_host_is_refused(served, host, path):
    found = served.request("POST" if path else "GET", served.path + path, b"{}", {"Host": host, "Content-Type": "application/json"})
    assert found.status == 400
    assert "<textarea" not in found.body


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"Origin": "http://evil.example"}, 403), ({"Origin": "null"}, 403), ({"Content-Type": "text/plain"}, 415),
        ({"Sec-Fetch-Site": "cross-site"}, 415), ({"Sec-Fetch-Site": "same-site"}, 415), ({"Sec-Fetch-Site": "same-origin"}, 200), ({}, 200),
    ],
)  # fmt: skip
def test_other_pages_cannot_ask_for_work(served, headers, status):
    body = json.dumps({"page": "t", "slot": "s", "work": "scenes", "program": PLAIN}).encode()
    assert served.request("POST", f"{served.path}work", body, {"Content-Type": "application/json", **headers}).status == status


def test_no_other_origin_is_allowed_and_nothing_is_kept_or_framed(served):
    for path in (served.path, "/"):
        headers = served.request("GET", path, headers={"Origin": f"http://{served.address.split('/')[2]}"}).headers
        assert not [name for name in headers if name.startswith("access-control")]
        assert headers["cache-control"] == "no-store"
        assert headers["x-content-type-options"] == "nosniff"
        assert headers["referrer-policy"] == "no-referrer"
        assert headers["x-frame-options"] == "DENY"


def test_the_page_loads_nothing_and_runs_its_own_script_alone(served):
    found = served.request("GET", served.path)
    policy = dict(part.strip().split(" ", 1) for part in found.headers["content-security-policy"].split(";"))
    assert policy["default-src"] == "'none'"
    assert policy["connect-src"] == "'self'"
    assert re.fullmatch(r"'sha256-[\w+/=]+'", policy["script-src"])
    assert re.fullmatch(r"'sha256-[\w+/=]+'", policy["style-src"])
    assert policy["require-trusted-types-for"] == "'script'"
    text = found.body.split('id="given"')[0] + found.body.split("</script>")[1]
    others = r"(?:src|href)=\"(?!data:)|https?://(?!www\.w3\.org/2000/svg|127\.0\.0\.1)"
    assert not re.search(rf"{others}|innerHTML|eval\(|@import|url\(", text)


@pytest.mark.parametrize(
    "body",
    [
        b"", b"no", b"[]", b"{}", b'{"work": "scenes"}', b'{"work": "other", "program": ""}', b"[" * 10**5, b"\xff",
        b'{"work": "scenes", "program": 3}',
        b'{"work": "scenes", "program": "", "seed": 1.5}', b'{"work": "scenes", "program": "", "seed": true}', b'{"work": ["scenes"], "program": ""}',
        b'{"work": "scenes", "program": "", "count": 100000}', b'{"work": "scenes", "program": "", "readings": [1]}',
        b'{"work": "simulate", "program": "", "timestep": -1}', b'{"work": "simulate", "program": "", "timestep": NaN}',
        b'{"work": "scenes", "program": "", "page": "' + b"x" * 1000 + b'"}', b'{"work": "scenes", "program": "' + b"x" * 2_000_001 + b'"}',
    ],
)  # fmt: skip
def test_what_is_no_request_is_told_so(served, body):
    found = served.request("POST", f"{served.path}work", body, {"Content-Type": "application/json"})
    assert found.status == 400
    assert 0 < len(found.body) < 200


# What each work answers


def test_scenes_are_those_of_run(served):
    found = [m for m in served.ask("scenes", FINITE, seed=5, count=4) if m["kind"] == "scene"]
    expected = list(scenic_ref.loads(FINITE).sample_many(4, 5))
    assert [(m["scene"], m["attempts"], m["objects"][1]["position"], m["params"]) for m in found] == [
        (i, s.attempts, [s.objects[1].position.x, s.objects[1].position.y], dict(s.params)) for i, s in enumerate(expected)
    ]


def test_an_answer_tells_what_rejected_and_which_features_there_are(served):
    found = served.ask("scenes", FINITE, count=12)
    [tally], [features] = ([m for m in found if m["kind"] == kind] for kind in ("tally", "features"))
    attempts = sum(m["attempts"] for m in found if m["kind"] == "scene")
    assert (tally["scenes"], tally["attempts"]) == (12, attempts)
    assert [(r["line"], r["count"]) for r in tally["stuck"]] == [(4, attempts - 12)]
    varying = {f["name"] for f in features["features"] if f["varies"]}
    assert {"params.x", "objects[1].position[0]", "distance(0, 1)"} <= varying
    assert features["names"] == {"0": "ego", "1": "other"}
    assert found[-1] == {"kind": "end"}


def test_an_error_has_its_place(served):
    error = served.only("scenes", "ego = Object at (0, 0)\nx = nosuch + 1\n", "error")["diagnostic"]
    assert (error["line"], error["column"], error["end_column"], error["severity"]) == (2, 5, 11, "error")
    assert "nosuch" in error["message"]


@pytest.mark.parametrize(
    ("program", "advice"),
    [
        ("import os\nego = Object at (0, 0)\n", "start `scenic-ref play --trust` if you know the code"),
        ("ego = Object at Range(0, 1) @ 0\nrequire ego.position.x > 0.9999999\n", "or save the program, and use `scenic-ref run --backend smc`"),
        ("model site_map\nego = Object at (0, 0)\n", "(`scenic-ref play --map site.geojson`)"),
    ],
)  # fmt: skip
def test_advice_can_be_followed_on_the_page(served, program, advice):
    assert advice in served.only("scenes", program, "error")["diagnostic"]["hint"]


def test_advice_for_the_command_line_that_the_page_changes_is_what_is_said():
    """So that none is forgotten where the words change."""
    layers = ("semantics", "interpreter", "inference", "api", "simulators", "playground")
    said = "".join(path.read_text() for layer in layers for path in (ROOT / layer).rglob("*.py") if path.name != "json_views.py")
    assert [command for command, _ in IN_PAGE if command not in said] == []


def test_a_map_is_named_by_an_option_also_without_a_file(serve, tmp_path):
    (tmp_path / "m.wkt").write_text("yard: POLYGON((0 0, 20 0, 20 20, 0 20, 0 0))\nfence: LINESTRING(1 5, 9 5)\n")
    with serve("--map", "m.wkt") as served:
        scene = served.only("scenes", "model site_map\nego = Object at (5, 5)\n", "scene", count=1)
        assert scene["params"]["map"] == "m.wkt"
        assert len(scene["ground"]["areas"]) == 2 and len(scene["ground"]["lines"]) == 1
        assert sorted(mark["text"] for mark in scene["ground"]["marks"]) == ["fence", "yard"]
        assert served.only("scenes", "ego = Object at (5, 5)\n", "checked", count=1)["diagnostics"][0]["kind"] == "unread parameter"


def test_what_ego_sees_is_sent_with_whether_that_is_all(served):
    near = served.only("scenes", "ego = Object at (5, 5)\n", "scene", count=1)
    far = served.only("scenes", "ego = Object at (5, 5)\nObject at (90, 5), with requireVisible False\n", "scene", count=1)
    assert near["view"] and near["allSeen"] and far["view"] and not far["allSeen"]


def test_what_rejects_is_told_while_no_scene_is_found(served):
    found = served.ask("scenes", "x = Range(0, 1)\nego = Object at (0, 0)\nrequire x > 1.5\n", count=1)
    tallies = [m for m in found if m["kind"] == "tally"]
    assert tallies[0]["attempts"] == 100
    assert tallies[-1]["stuck"][0]["line"] == 3
    [error] = [m for m in found if m["kind"] == "error"]
    assert error["exhausted"]


def test_the_reading_of_the_coin_changes_scenes(served):
    program = "x = Range(0, 1)\nego = Object at (0, 0)\nrequire[0.5] x < 0.1\nparam x = x\n"
    run, scene = (served.ask("scenes", program, count=12, readings={"soft": answer}) for answer in ("run", "scene"))
    held = [sum(m["params"]["x"] < 0.1 for m in found if m["kind"] == "scene") for found in (run, scene)]
    assert held[0] < held[1]
    assert [m["coins"] for m in (*run, *scene) if m["kind"] == "tally"] == [False, True]


def test_a_survey_finds_the_readings_that_matter(served):
    program = "x = Range(0, 1)\nego = Object at (0, 0)\nrequire[0.5] x < 0.1\nparam x = x\n"
    found = {(m["reading"], m["answer"]): m for m in served.ask("survey", program, count=6) if m["kind"] == "survey"}
    assert found["soft", "scene"]["changed"]
    assert found["soft", "scene"]["what"][0] == "params.x"
    assert found["pairs", "tuple"]["changed"] == []


def test_an_unknown_reading_is_told(served):
    assert "no reading nosuch" in served.only("scenes", PLAIN, "error", readings={"nosuch": "x"})["diagnostic"]["message"]


def test_the_values_of_a_feature_are_those_of_the_scenes(served):
    values = [v for m in served.ask("histogram", PLAIN, feature="params.x", count=20, seed=3) if m["kind"] == "values" for v in m["values"]]
    assert values == [s.params["x"] for s in scenic_ref.loads(PLAIN).sample_many(20, 3)]


def test_an_expression_is_evaluated_in_the_same_scenes_after_mutation(served):
    program = PLAIN + "mutate\n"
    values = [v for m in served.ask("histogram", program, expression="other.position.x", count=12) if m["kind"] == "values" for v in m["values"]]
    assert values == [s.objects[1].position.x for s in scenic_ref.loads(program).sample_many(12)]
    truths = [v for m in served.ask("histogram", PLAIN, expression="ego can see other", count=5) if m["kind"] == "values" for v in m["values"]]
    assert truths == [True] * 5


@pytest.mark.parametrize(
    ("expression", "said"),
    [
        ("Range(0, 1)", "cannot draw"), ("nosuch", "not defined"), ("x = 3", "no expression"), ("1)\nego = Object\n(2", "expected"),
        ("other.nosuch", "nosuch"), ("1 / 0", "ZeroDivisionError"), ("[0] * 10**9", "too many"), ("", ""), ("open('/etc/passwd')", "open"),
    ],
)  # fmt: skip
def test_a_wrong_expression_is_told_so(served, expression, said):
    found = served.ask("histogram", PLAIN, expression=expression, feature="params.x" if not expression else "", count=3)
    errors = [m["diagnostic"]["message"] + " ".join(m["diagnostic"]["expected"]) for m in found if m["kind"] == "error"]
    assert not errors if not expression else len(errors) == 1 and (said in errors[0] or said == "expected")


def test_a_finite_program_has_an_exact_law(served):
    law = served.only("law", FINITE, "law", feature="params.x")
    assert (law["acceptance"], {e["value"]: e["probability"] for e in law["law"]}) == ("2/3", {1.0: "1/2", 2.0: "1/2"})
    law = served.only("law", FINITE, "law", expression="other.position.x > 5")
    assert {e["value"]: e["probability"] for e in law["law"]} == {False: "1/2", True: "1/2"}
    law = served.only("law", FINITE, "law", feature="attempts")
    assert [e["probability"] for e in law["law"][:2]] == ["2/3", "2/9"]


def test_an_infinite_program_has_none(served):
    assert "infinitely many" in served.only("law", PLAIN, "nolaw", feature="params.x")["why"]


def test_a_trace_has_every_rule_of_the_scene(served):
    found = served.only("trace", FINITE, "trace", start=1)
    assert any(e["kind"] == "draw" and e["line"] == 1 for e in found["events"])
    assert found["ending"].startswith("accepted")
    attempts = scenic_ref.loads(FINITE).sample(0, 1).attempts
    assert found["attempt"] == attempts


def test_a_rejected_attempt_can_be_traced(served):
    index = next(k for k in range(50) if scenic_ref.loads(FINITE).sample(0, k).attempts > 1)
    found = served.only("trace", FINITE, "trace", start=index, attempt=1)
    assert found["events"][-1]["kind"] == "stuck"
    assert found["events"][-1]["line"] == 4


def test_a_simulation_is_played(served):
    program = (Path(scenic_ref.__file__).parent / "examples" / "dynamic" / "stop_in_time.scenic").read_text()
    found = served.ask("simulate", program, simulator="kinematic", steps=60, timestep=0.1)
    [run] = [m for m in found if m["kind"] == "run"]
    assert run["run"]["steps"][5]["objects"][0]["position"][1] > 0
    assert found[-2]["kind"] == "simulated"


def test_a_simulator_that_is_not_shipped_is_refused(served):
    for name in ("os:system", "nosuch", ""):
        assert "no simulator" in served.only("simulate", PLAIN, "error", simulator=name, steps=1)["diagnostic"]["message"]


@pytest.mark.parametrize(("form", "begins"), [("png", "iVBORw0KGgo"), ("svg", "PD94bWwg")])
def test_pictures_are_those_of_run(served, form, begins):
    found = served.only("picture", PLAIN, "file", form=form, count=2)
    assert found["data"].startswith(begins)


# What a program cannot do


def test_an_endless_loop_is_told_and_the_server_lives_on(served):
    error = served.only("scenes", ENDLESS, "error")["diagnostic"]
    assert "without ending" in error["message"]
    assert error["line"] in (1, 2)
    assert [m["kind"] for m in served.ask("scenes", PLAIN, count=1)][-1] == "end"


def test_time_is_limited_whatever_the_program_does(serve):
    with serve("--limit-seconds", "1", "--fuel", "1000000000") as server:
        server.ask("scenes", PLAIN)
        found = server.ask("scenes", SLOW)
        assert found[-1]["kind"] == "over"
        assert "1 s, is over" in found[-1]["message"]
        assert server.ask("scenes", PLAIN, count=1)[-1] == {"kind": "end"}


@pytest.mark.parametrize(
    "program", ["x = [0] * 10**9\nego = Object\n", "x = 'a'\nfor i in range(60):\n    x = x + x\nego = Object\n", "x = 10 ** 10 ** 9\nego = Object\n"]
)
def test_memory_is_limited(served, program):
    assert [m["kind"] for m in served.ask("scenes", program)][-2:] == ["error", "end"]


@pytest.mark.parametrize(
    "program",
    [
        "open('made', 'w')", "import os", "import socket", "ego = Object at (0, 0)\nparam x = __import__('os')", "from nosuch import *",
        "model nosuch", "import conftest", "(" * 5000, "x = " + "-" * 100_000 + "1", "\0", "\ud800", "\u202e",
        "ego = Object at (0, 0), with note '\ud800\u2028</script>'",
    ],
)  # fmt: skip
def test_a_bad_program_ends_in_an_answer(served, program):
    kinds = [m["kind"] for m in served.ask("scenes", program, count=1)]
    assert kinds[-1] == "end"
    assert "fault" not in kinds
    assert set(kinds) & {"error", "scene"}


def test_modules_are_found_beside_the_file_and_nowhere_else(serve, tmp_path):
    (tmp_path / "secret.scenic").write_text("secret = 12345\n")
    program = "import secret\nego = Object at (0, 0)\nparam x = secret.secret\n"
    with serve() as server:
        assert "secret" in server.only("scenes", program, "error", count=1)["diagnostic"]["message"]
    (tmp_path / "main.scenic").write_text(program)
    with serve("main.scenic") as server:
        assert server.only("scenes", program, "scene", count=1)["params"] == {"x": 12345}


def test_texts_are_cut_and_cannot_hide(served):
    program = "ego = Object at (0, 0), with note 'x' * 1000000, with turn '\u202eevil', with many [[1] * 1000]\n"
    [o] = served.only("scenes", program, "scene", count=1)["objects"]
    assert o["properties"]["note"].endswith("(1,000,000 characters)")
    assert len(o["properties"]["note"]) < 500
    assert o["properties"]["turn"] == "\\u202eevil"
    assert len(o["properties"]["many"][0]) < 200


def test_a_scene_of_too_many_objects_or_too_far_away_is_not_drawn(served):
    crowd = "ego = Object at (0, 0)\nfor i in range(1100):\n    Object at (2 * i + 2, 0), with requireVisible False, with allowCollisions True\n"
    assert "too many" in served.only("scenes", crowd, "scene", count=1)["problem"]
    assert "coordinates" in served.only("scenes", "ego = Object at (1e12, 0)\n", "scene", count=1)["problem"]


def workers(server) -> Iterator[int]:
    """The processes that work for a server and are busy: those that were forked from the one that it forks them from."""
    family = {server.pid: 0}
    for _ in range(3):
        for path in Path("/proc").iterdir():
            if path.name.isdigit():
                try:
                    parent = int((path / "stat").read_text().rpartition(")")[2].split()[1])
                except OSError:
                    continue
                if parent in family:
                    family.setdefault(int(path.name), family[parent] + 1)
    yield from (number for number, depth in family.items() if depth == 2)


def until(condition: Callable[[], object]) -> None:
    """Wait until something is so, however long that takes."""
    while not condition():
        time.sleep(0.02)


def begun(server) -> tuple[threading.Thread, list[dict[str, object]]]:
    """A thread that asks for endless work, which has begun, and a list for its messages."""
    server.ask("scenes", PLAIN)
    until(lambda: not list(workers(server)))
    found: list[dict[str, object]] = []

    def asking() -> None:
        with suppress(OSError, http.client.HTTPException):
            found.extend(server.ask("scenes", ENDLESS))

    thread = threading.Thread(target=asking, daemon=True)
    thread.start()
    until(lambda: list(workers(server)))
    return thread, found


linux = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="this system has no /proc")


@linux
@pytest.mark.slow
def test_a_process_that_crashes_is_told_and_the_server_lives_on(serve):
    with serve("--limit-seconds", "none", "--fuel", "1000000000") as server:
        asking, found = begun(server)
        os.kill(next(workers(server)), signal.SIGSEGV)
        asking.join()
        assert found[-1]["kind"] == "over"
        assert "signal 11" in str(found[-1]["message"])
        assert server.ask("scenes", PLAIN, count=1)[-1] == {"kind": "end"}


@linux
@pytest.mark.slow
def test_a_newer_request_ends_the_work_of_the_older_one(serve):
    with serve("--limit-seconds", "none", "--fuel", "1000000000") as server:
        asking, found = begun(server)
        assert server.ask("scenes", PLAIN, count=1)[-1] == {"kind": "end"}
        asking.join()
        assert found[-1] == {"kind": "replaced"}
        until(lambda: not list(workers(server)))


@linux
@pytest.mark.slow
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_no_process_is_left_however_the_server_ends(serve, how):
    with serve("--limit-seconds", "none", "--fuel", "1000000000") as server:
        _, found = begun(server)
        busy = list(workers(server))
        server.send_signal(how)
        code = server.wait()
        assert code == {signal.SIGINT: 0, signal.SIGTERM: -15, signal.SIGKILL: -9}[how]
        until(lambda: not any(Path(f"/proc/{number}").exists() for number in busy))
        assert "Traceback" not in server.stderr.read()
        assert how == signal.SIGKILL or "ended" in str(found[-1]["message"])


# The command


def test_a_port_that_is_taken_is_told(served, capfd):
    port = served.address.split(":")[2].split("/")[0]
    assert run_command_line(["play", "--no-browser", "--port", port]) == 2
    assert f"port {port} cannot be used" in capfd.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "said"), [(["nosuch.scenic"], "nosuch.scenic"), (["#scenic1=AAAA"], "holds no program"), (["--reading", "x"], "ID=ALT")]
)
def test_wrong_usage_is_told(capfd, tmp_path, monkeypatch, arguments, said):
    monkeypatch.chdir(tmp_path)
    assert run_command_line(["play", "--no-browser", *arguments]) == 2
    assert said in capfd.readouterr().err


def test_the_file_is_what_the_page_begins_with_and_is_not_written(serve, tmp_path):
    (tmp_path / "mine.scenic").write_text("ego = Object at (1, 2)  # </script><b>\n")
    with serve("mine.scenic", "--seed", "7", "--reading", "soft=scene") as server:
        page = server.request("GET", server.path).body
        given = json.loads(page.split('id="given">')[1].split("</script>")[0])
        assert (given["file"], given["program"], given["seed"]) == ("mine.scenic", "ego = Object at (1, 2)  # </script><b>\n", 7)
        under = {r["id"]: r["under"] for r in given["readings"]}
        assert set(under["soft"].values()) == {"scene"}  # the command line's, whatever the profile
        assert (under["time-unit"]["paper"], under["time-unit"][given["dialects"]["scenic-3"]]) == ("seconds", "steps")
        assert (given["profile"], given["dialect"]) == (None, None)
        server.ask("scenes", "ego = Object at (5, 5)\n", count=1)
    assert (tmp_path / "mine.scenic").read_text() == "ego = Object at (1, 2)  # </script><b>\n"


def test_connections_on_which_nobody_asks_leave_room_for_those_who_do(served):
    parts = urlsplit(served.address)
    idle = [socket.create_connection((parts.hostname, parts.port)) for _ in range(200)]
    try:
        for _ in range(3):
            assert served.request("GET", served.path).status == 200
        assert select.select(idle, [], [], 100)[0]  # one that was idle is closed
    finally:
        for connection in idle:
            connection.close()
