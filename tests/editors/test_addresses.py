"""Files have addresses in which editors write some characters with a percent sign."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from .conftest import Editor

pytestmark = pytest.mark.extra("lsp")
CAR = "class Car:\n    doors: 4\n"


@pytest.mark.parametrize("name", ["my car.scenic", "ü.scenic", "a%20b.scenic", "50%.scenic", "🚗.scenic", "c#.scenic"])
def test_a_file_is_known_whatever_its_name(editor: Editor, name):
    (editor.folder / "cars.scenic").write_text(CAR)
    wrong = "ego = Object at 0 @ 0, with widht 5\n"
    assert [p.code for p in editor.checked(name, wrong)] == ["unread property"]
    editor.change(name, "ego = Object at\n", 2)
    assert [p.code for p in editor.problems(name, 2)] == ["syntax error"]
    before = len(editor.published)
    editor.save(name)
    assert [p.code for p in editor.problems(name, 2, before)] == ["syntax error"]
    assert "width" in editor.complete("ego = Object with wi|", name)
    shown = editor.hover("ego = Object f|acing 1\n", name)
    assert shown is not None and "facing" in shown[0]
    assert editor.definitions("from cars import Car\nego = C|ar\n", name) == [("cars.scenic", (0, 6, 0, 9))]
    before = len(editor.published)
    editor.close(name)
    editor.until(lambda: any(p.uri == editor.uri(name) and not p.diagnostics for p in editor.published[before:]))


def test_a_definition_stands_in_the_file_as_the_editor_calls_it(editor: Editor):
    name = "a ü 🚗.scenic"
    place = editor.at(name, "x = 1\nego = Object at |x @ 0\n")
    (found,) = editor.do(editor.client.text_document_definition_async(editor.types.DefinitionParams(**place)))
    assert found.uri == editor.uri(name)


@pytest.mark.parametrize("key", ["file:///a b.scenic", "file:///a%20b.scenic"])
def test_a_document_is_found_whatever_pygls_calls_it(key: str, monkeypatch: pytest.MonkeyPatch):
    """It is the first from pygls 2.1 on, and was the second before."""
    from scenic_ref.editors.server import ScenicServer

    monkeypatch.setattr(ScenicServer, "workspace", SimpleNamespace(text_documents={key: "the document"}))
    assert ScenicServer(1).opened("file:///a%20b.scenic") == "the document"
