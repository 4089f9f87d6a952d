"""`scenic-ref lsp`, as an editor meets it: a process that speaks on its standard streams."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from scenic_ref.cli import run_command_line

from .conftest import Editor

pytestmark = pytest.mark.extra("lsp")
ERROR, WARNING, INFORMATION = 1, 2, 3
ENDLESS = "ego = Object\nwhile True:\n    pass\n"
CAR = "# A car.\nclass Car(Object):\n    width: 2\n    doors: 4\n\nparked = Car at 9 @ 9\n"


def children(number: int) -> list[int]:
    """The processes that a process started and that are there."""
    return [int(n) for n in Path(f"/proc/{number}/task/{number}/children").read_text().split()]


def alive(number: int) -> bool:
    return Path(f"/proc/{number}").exists() and "\nState:\tZ" not in Path(f"/proc/{number}/status").read_text()


# -- Diagnostics


def test_an_error_has_its_place_its_message_with_the_hint_and_a_code(editor: Editor):
    (found,) = editor.checked("main.scenic", "ego = Object\nx = Object at 5 @ 3, wiht width 3\n")
    assert found == (ERROR, "`wiht` is not a specifier\ndid you mean `with`?", "syntax error", (1, 21, 1, 25))


def test_warnings_are_told_and_a_good_program_has_none(editor: Editor):
    (found,) = editor.checked("main.scenic", "ego = Object with widht 3\n")
    assert found == (WARNING, "nothing reads the property widht\ndid you mean width?", "unread property", (0, 18, 0, 23))
    editor.change("main.scenic", "ego = Object with width 3\n", 2)
    assert editor.problems("main.scenic", 2) == []


def test_an_error_of_a_rule_has_the_rule_as_its_code(editor: Editor):
    (found,) = editor.checked("main.scenic", "ego = Object at 1 @ 1, at 2 @ 2\n")
    assert found.code == "R-SpecifiedTwice"


def test_columns_are_in_units_of_utf_16(editor: Editor):
    (found,) = editor.checked("main.scenic", 'a = "😋é𝔘e\u0301"; ego = Object at nosuch\n')
    line = 'a = "😋é𝔘e\u0301"; ego = Object at nosuch'
    start = len(line[: line.index("nosuch")].encode("utf-16-le")) // 2
    assert found.range == (0, start, 0, start + 6)


@pytest.mark.slow
@pytest.mark.parametrize(("encoding", "start"), [("utf-8", 28), ("utf-16", 26), ("utf-32", 25)])
def test_columns_are_in_units_that_the_editor_prefers(tmp_path, encoding, start):
    editor = Editor(tmp_path, encodings=[encoding])
    assert editor.capabilities.position_encoding == encoding
    (found,) = editor.checked("main.scenic", 'a = "😋"; ego = Object at nosuch\n')
    assert found.range == (0, start, 0, start + 6)
    assert editor.goodbye() == (0, "")


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_lines_end_as_the_protocol_says(editor: Editor, end):
    text = end.join(["a = 1\u2028", "\tego = 1", ""]).replace("\u2028", "  # \u2028\x0b\x0c")
    (found,) = editor.checked("main.scenic", text)
    assert found.range[0] == 1
    (other,) = editor.checked("other.scenic", f"ego = Object{end}x = [1,{end}\t\tnosuch]")
    assert other.range == (2, 2, 2, 8)


def test_a_byte_order_mark_takes_a_column(editor: Editor):
    (found,) = editor.checked("main.scenic", "\ufeffego = nosuch\n")
    assert found.range == (0, 7, 0, 13)


def test_half_a_character_is_told(editor: Editor):
    (found,) = editor.checked("main.scenic", "ego = Object\nx = '\ud83d' + 1")
    assert found.severity == ERROR
    assert found.range[0] == 1


@pytest.mark.parametrize("text", ["class Car:\n    width: 2\n", "", "\n  # soon\n"])
def test_a_file_without_objects_is_no_error(editor: Editor, text):
    (found,) = editor.checked("lib.scenic", text)
    assert found.severity == INFORMATION
    assert "ego" in found.message


def test_a_fault_in_a_module_stands_at_its_import_and_names_its_place(editor: Editor):
    (editor.folder / "lib.scenic").write_text("x = 1\ny = nosuch\n")
    (found,) = editor.checked("main.scenic", "import math\nimport lib\nego = Object at math.pi @ lib.x\n")
    assert found.range == (1, 0, 1, 10)
    assert found.message.startswith("lib.scenic:2:5: ")


def test_what_imports_a_module_is_checked_again_when_that_is_saved(editor: Editor):
    (editor.folder / "lib.scenic").write_text("x = nosuch\n")
    assert len(editor.checked("main.scenic", "import lib\nego = Object at 0 @ lib.x\n")) == 1
    (editor.folder / "lib.scenic").write_text("x = 1\n")
    before = len(editor.published)
    editor.save("lib.scenic")
    assert editor.problems("main.scenic", after=before) == []


def test_the_first_line_chooses_the_dialect_and_a_wrong_one_is_told(editor: Editor):
    assert editor.checked("main.scenic", "# dialect: scenic-3\nego = new Object\n") == []
    (found,) = editor.checked("other.scenic", "# dialect: scenic-4\nego = new Object\n")
    assert "scenic-4" in found.message
    assert found.range == (0, 0, 0, 19)


def test_a_closed_file_has_no_diagnostics(editor: Editor):
    assert editor.checked("main.scenic", "ego = nosuch\n")
    editor.close("main.scenic")
    assert editor.problems("main.scenic", None) == []


def test_only_the_newest_text_is_told_of(editor: Editor):
    editor.open("main.scenic", ENDLESS)
    for version in range(2, 9):
        editor.change("main.scenic", f"ego = nosuch{version}\n", version)
    assert "nosuch8" in editor.problems("main.scenic", 8)[0].message
    assert {p.version for p in editor.published} == {8}


@pytest.mark.slow
def test_a_program_that_does_not_end_is_told_of_and_delays_no_answer(tmp_path):
    editor = Editor(tmp_path, ["--stdio", "--limit-seconds", "1"])
    editor.open("main.scenic", ENDLESS)
    assert editor.hover("x = Ran|ge(0, 1)", "other.scenic")
    assert not [p for p in editor.published if p.uri == editor.uri("main.scenic")]
    (found,) = editor.problems("main.scenic")
    assert "without ending" in found.message
    assert editor.checked("third.scenic", "ego = Object\n") == []
    assert editor.goodbye() == (0, "")


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc").is_dir(), reason="this system has no /proc")
def test_an_endless_check_of_an_old_text_is_ended_for_the_new_one(tmp_path):
    editor = Editor(tmp_path, ["--limit-seconds", "1000000"])
    first = busy(editor, "ego = Object\nx = 1\n" + "for i in range(1000000): x = x + i\n" * 100)
    editor.change("main.scenic", "ego = Object\n", 2)
    assert editor.problems("main.scenic", 2) == []
    assert not alive(first)
    assert editor.goodbye() == (0, "")


def busy(editor: Editor, text: str) -> int:
    """The process that checks a text without end; what it takes to start is not what it takes to check."""
    assert editor.checked("before.scenic", "ego = Object\n") == []
    (process,) = children(editor.server.pid)
    start = processor(process)
    editor.open("main.scenic", text)
    editor.until(lambda: processor(process) > start + 1)
    return process


def processor(number: int) -> float:
    """The seconds of the processor that a process has taken."""
    fields = Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def test_a_program_has_neither_the_files_nor_the_streams_of_the_server(editor: Editor):
    (editor.folder / "helper.py").write_text("print('Content-Length: 1')\n")
    (found,) = editor.checked("main.scenic", "import helper\nego = Object\nprint('Content-Length: 3')\n")
    assert "needs --trust" in found.message
    assert editor.checked("other.scenic", "ego = Object\nprint('Content-Length: 3')\n") == []


def test_a_file_of_the_folder_replaces_no_module_of_the_server(tmp_path):
    (tmp_path / "lark.py").write_text("raise SystemExit('the folder was searched')\n")
    editor = Editor(tmp_path)
    assert editor.checked("main.scenic", "ego = Object\n") == []
    assert editor.goodbye() == (0, "")


def test_a_check_whose_process_was_killed_is_told_and_the_next_one_works(editor: Editor):
    first = busy(editor, "ego = Object\n" + ENDLESS)
    os.kill(first, signal.SIGKILL)
    assert "ended unexpectedly" in editor.problems("main.scenic")[0].message
    assert editor.checked("other.scenic", "ego = Object\n") == []


def test_a_program_that_is_too_long_is_not_checked(editor: Editor):
    (found,) = editor.checked("main.scenic", "ego = Object\n" + "# a line\n" * 150_000)
    assert found.severity == INFORMATION
    assert "more than 1,000,000 characters" in found.message
    assert editor.hover("ego = Object|\n" + "# a line\n" * 150_000, "main.scenic") is None


@pytest.mark.parametrize("text", ["", "\n", "(" * 5000, '"""', "\0", "ego = Object at (", "class", "\\", "\ufeff", "x" * 100_000])
def test_what_is_no_program_is_an_error_with_a_place(editor: Editor, text):
    (found,) = editor.checked("main.scenic", text)
    assert found.message
    assert found.range[:2] <= found.range[2:]


def test_an_untitled_text_is_checked(editor: Editor):
    (found,) = editor.checked("untitled:Untitled-1", "ego = nosuch")
    assert found.range == (0, 6, 0, 12)


# -- Hover


def test_a_specifier_is_shown_with_its_rules_and_their_place_in_the_paper(editor: Editor):
    text, place = editor.hover("ego = Object\nx = Object left |of ego by 3\n") or ("", ())
    assert "⟦left of V by S⟧ = ⟦V⟧ + rotate(" in text
    assert "**P-LeftOf-Vector**" in text
    assert 'Figure "Semantics of position specifiers"' in text
    assert "specifies `position`, optionally `heading`; depends on `width`" in text
    assert place == (1, 11, 1, 18)


def test_the_place_of_what_is_shown_counts_in_utf_16(editor: Editor):
    found = editor.hover('x = "😋é"; ego = Obj|ect\n')
    assert found is not None
    assert "class Object(OrientedPoint)" in found[0]
    assert found[1] == (0, 17, 0, 23)


def test_a_class_of_another_file_is_shown_with_its_comment_and_properties(editor: Editor):
    (editor.folder / "cars.scenic").write_text(CAR)
    text, _ = editor.hover("from cars import Car\nego = C|ar\n") or ("", ())
    assert "class Car(Object):" in text
    assert "A car." in text
    assert "`doors: 4`" in text
    assert "in `cars.scenic`, line 2" in text


def test_a_module_that_is_open_is_shown_as_it_is_there(editor: Editor):
    (editor.folder / "cars.scenic").write_text(CAR)
    editor.open("cars.scenic", CAR.replace("doors: 4", "doors: 5"))
    text, _ = editor.hover("import cars\nego = cars.C|ar\n") or ("", ())
    assert "`doors: 5`" in text


def test_nothing_is_shown_in_comments_and_texts_and_beyond_the_end(editor: Editor):
    assert editor.hover("# Obj|ect\n") is None
    assert editor.hover('x = "Obj|ect"\n') is None
    assert editor.hover("\n\n|") is None


# -- Completion


def test_specifiers_are_suggested_where_an_object_is_built(editor: Editor):
    for text in ("ego = Object |", "ego = Object at 1 @ 1, |", "ego = Object at 1 @ 1,\n    |", "f(Object at 1 @ 1, |"):
        assert {"at", "left of", "facing toward", "with"} <= set(editor.complete(text)), text
    assert "with" not in editor.complete("x = 1 + |")


def test_a_suggestion_replaces_what_of_it_is_written(editor: Editor):
    item = editor.complete('x = "😋"; ego = Object at 1 @ 1, facing to|')["facing toward"]
    edit = item.text_edit
    assert (edit.range.start.character, edit.range.end.character, edit.new_text) == (33, 42, "facing toward")


def test_properties_are_suggested_behind_with_and_behind_a_dot(editor: Editor):
    (editor.folder / "cars.scenic").write_text(CAR)
    assert {"width", "doors"} <= set(editor.complete("from cars import *\nego = Car with |"))
    assert {"width", "doors"} <= set(editor.complete("from cars import *\nego = Car\nx = ego.d|"))
    assert "doors" not in editor.complete("from cars import *\nego = Object with |")


def test_names_of_the_program_and_of_modules_are_suggested_in_one_that_does_not_parse(editor: Editor):
    (editor.folder / "cars.scenic").write_text(CAR)
    found = editor.complete("from cars import *\nmodel gtaLib\nclass Bus(Object:\n    width 3\nx = = 4\nego = |")
    assert {"Car", "parked", "Bus", "x", "EgoCar", "Range", "Object"} <= set(found)


def test_a_space_asks_for_nothing_but_what_is_likely(editor: Editor):
    assert editor.complete("x = |", typed=" ") == {}
    assert editor.complete("|", typed=" ") == {}
    assert "facing" in editor.complete("ego = Object |", typed=" ")
    assert "width" in editor.complete("ego = Object with |", typed=" ")
    assert "mars" in editor.complete("import |", typed=" ")


# -- Definitions


def test_a_name_leads_to_its_definition_in_another_file(editor: Editor):
    (editor.folder / "cars.scenic").write_text(CAR)
    place = ("cars.scenic", (1, 6, 1, 9))
    assert editor.definitions("from cars import Car\nego = C|ar\n") == [place]
    assert editor.definitions("from cars import C|ar\n") == [place]
    assert editor.definitions("import cars as c\nego = c.C|ar\n") == [place]
    assert editor.definitions("from cars import *\nego = C|ar\n") == [place]
    assert editor.definitions("model cars\nego = C|ar\n") == [place]
    assert editor.definitions("from cars import *\nego = Car with do|ors 3\n") == [("cars.scenic", (3, 4, 3, 9))]
    assert editor.definitions("import ca|rs\n") == [("cars.scenic", (0, 0, 0, 0))]


def test_a_world_model_leads_to_its_file(editor: Editor):
    ((file, place),) = editor.definitions("from gtaLib import *\nego = C|ar\n")
    assert file == "model.scenic"
    assert place[1:] == (6, place[0], 9)


def test_names_of_a_behavior_lead_to_it_and_its_parameters(editor: Editor):
    text = "behavior Drive(speed):\n    take speed\nego = Object with behavior Drive(3)\n"
    assert editor.definitions(text.replace("Drive(3)", "Dri|ve(3)")) == [("main.scenic", (0, 9, 0, 14))]
    assert editor.definitions(text.replace("take speed", "take sp|eed")) == [("main.scenic", (0, 15, 0, 20))]
    assert editor.definitions(text.replace("Drive(3)", "Drive(sp|eed=3)")) == [("main.scenic", (0, 15, 0, 20))]


def test_what_has_no_definition_leads_nowhere(editor: Editor):
    assert editor.definitions("x = no|such\n") == []
    assert editor.definitions("ego = Obj|ect\n") == []


def test_the_outline_has_classes_with_their_properties(editor: Editor):
    t = editor.types
    editor.open("cars.scenic", CAR)
    document = t.TextDocumentIdentifier(editor.uri("cars.scenic"))
    found = editor.do(editor.client.text_document_document_symbol_async(t.DocumentSymbolParams(document))) or []
    assert [(s.name, [c.name for c in s.children or ()]) for s in found] == [("Car", ["width", "doors"]), ("parked", [])]  # type: ignore[union-attr]


# -- The process


def test_what_is_not_of_the_protocol_does_not_end_the_server(tmp_path):
    editor = Editor(tmp_path)
    stdin = editor.server.stdin
    wrong = (b'{"jsonrpc": "2.0", "id": 1, "method": "no/such"}', b'{"jsonrpc": "2.0", "method": "textDocument/didOpen", "params": 3}')
    for body in (b"{nonsense", *wrong):
        stdin.write(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))
    t = editor.types
    asked = t.HoverParams(t.TextDocumentIdentifier("file:///nowhere"), t.Position(5, 5))
    assert editor.do(editor.client.text_document_hover_async(asked)) is None
    assert editor.checked("main.scenic", "ego = Object\n") == []
    code, said = editor.goodbye()
    assert code == 0
    assert "Unable to handle message" in said


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc").is_dir(), reason="this system has no /proc")
@pytest.mark.parametrize("how", ["shutdown", "closed", "killed"])
def test_no_process_is_left(tmp_path, how):
    editor = Editor(tmp_path, ["--limit-seconds", "1000000"])
    worker = busy(editor, ENDLESS)
    if how == "shutdown":
        assert editor.goodbye() == (0, "")
    elif how == "closed":
        editor.server.stdin.close()
    else:
        editor.server.kill()
    editor.do(editor.server.wait())
    while alive(worker):
        time.sleep(0.01)


@pytest.mark.parametrize("moment", ["started", "listening", "checking"])
def test_the_process_has_ended_when_the_checks_have(moment):
    from scenic_ref.editors.live_checks import CheckingQueue, Revision

    async def begun_and_ended():
        queue = CheckingQueue(1000, lambda text, found: None)
        queue.begin()
        process = None if moment == "started" else await queue.process.ready()
        if moment == "checking":
            queue.changed(Revision("file:///a", 1, ENDLESS, "a.scenic", None), 0)
            while not queue.process.busy:
                await asyncio.sleep(0.01)
        await queue.end()
        assert process is None or process.returncode == -signal.SIGKILL
        return [*asyncio.all_tasks() - {asyncio.current_task()}]

    before = children(os.getpid())
    assert asyncio.run(begun_and_ended()) == []
    assert children(os.getpid()) == before


@pytest.mark.parametrize("text", ["", ENDLESS])
def test_an_editor_need_not_wait_for_an_answer_to_its_good_bye(tmp_path, text):
    def message(method, number=None, **params):
        body = json.dumps({"jsonrpc": "2.0", "method": method, "params": params, **({} if number is None else {"id": number})}).encode()
        return b"Content-Length: %d\r\n\r\n" % len(body) + body

    document = {"uri": "file:///a.scenic", "languageId": "scenic", "version": 1, "text": text}
    said = message("initialize", 1, capabilities={}, processId=None) + message("initialized") + message("textDocument/didOpen", textDocument=document)
    command = [sys.executable, "-P", "-m", "scenic_ref", "lsp"]
    for ended, code in ((message("shutdown", 2) + message("exit"), 0), (message("exit"), 1)):
        done = subprocess.run(command, input=said + ended, cwd=tmp_path, capture_output=True, check=False)
        assert (done.returncode, done.stderr) == (code, b"")


def test_tcp_serves_one_client_of_this_machine_and_no_web_page(tmp_path):
    for request, answered in ((b"POST / HTTP/1.1\r\n", False), (b"", True)):
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        with subprocess.Popen([sys.executable, "-P", "-m", "scenic_ref", "lsp", "--tcp", str(port)], cwd=tmp_path, stderr=subprocess.PIPE) as server:
            connection = connected(port, server)
            body = json.dumps({"jsonrpc": "2.0", "id": 1, "method": "initialize", "params": {"capabilities": {}, "processId": None}}).encode()
            connection.sendall(request + b"Content-Length: %d\r\n\r\n" % len(body) + body)
            assert bool(heard(connection)) is answered
            connection.close()
            assert server.wait() == 0


def heard(connection: socket.socket) -> bytes:
    try:
        return connection.recv(10)
    except ConnectionResetError:
        return b""


def connected(port: int, server: subprocess.Popen[bytes]) -> socket.socket:
    """The connection, once the server listens."""
    while True:
        assert server.poll() is None
        try:
            return socket.create_connection(("127.0.0.1", port))
        except ConnectionRefusedError:
            time.sleep(0.01)


def test_a_port_in_use_and_wrong_options_are_wrong_usage(capfd):
    with socket.socket() as used:
        used.bind(("127.0.0.1", 0))
        used.listen()
        assert run_command_line(["lsp", "--tcp", str(used.getsockname()[1])]) == 2
    assert "cannot be used" in capfd.readouterr().err
    assert run_command_line(["lsp", "--stdio", "--tcp", "7000"]) == 2
    assert run_command_line(["lsp", "--limit-seconds", "none"]) == 2
    assert run_command_line(["lsp", "--tcp", "0"]) == 2
