"""An editor as a test plays it: pygls's client, and a server in a process of its own."""

from __future__ import annotations

import asyncio
import os
import sys
from collections.abc import Awaitable, Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import pytest

if TYPE_CHECKING:
    from lsprotocol import types
    from pygls.lsp.client import LanguageClient

T = TypeVar("T")


class Problem(NamedTuple):
    """A diagnostic: its severity (1 error, 2 warning, 3 information), message, code, and range (line, character, line, character)."""

    severity: int
    message: str
    code: str
    range: tuple[int, int, int, int]


def of_range(found: types.Range) -> tuple[int, int, int, int]:
    """A range in one tuple."""
    return found.start.line, found.start.character, found.end.line, found.end.character


class Editor:
    """Speaks to `scenic-ref lsp`; `at` marks a place by `|` in a text."""

    def __init__(self, folder: Path, arguments: Sequence[str] = (), encodings: Sequence[str] | None = None) -> None:
        from lsprotocol import types
        from pygls.lsp.client import LanguageClient

        self.types = types
        self.folder = folder
        self.loop = asyncio.new_event_loop()
        self.client: LanguageClient = LanguageClient("test", "1")
        self.opened: set[str] = set()
        self.published: list[types.PublishDiagnosticsParams] = []
        self.client.feature(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)(lambda params: self.published.append(params))
        command = (sys.executable, "-P", "-m", "scenic_ref", "lsp", *arguments)
        self.do(self.client.start_io(*command, cwd=str(folder)))
        general = types.GeneralClientCapabilities(position_encodings=list(encodings) if encodings else None)
        wanted = types.InitializeParams(capabilities=types.ClientCapabilities(general=general), process_id=os.getpid())
        self.capabilities = self.do(self.client.initialize_async(wanted)).capabilities
        self.client.initialized(types.InitializedParams())

    def do(self, awaitable: Awaitable[T]) -> T:
        """What an answer is."""
        return self.loop.run_until_complete(awaitable)

    @property
    def server(self) -> Any:
        """The process of the server."""
        return self.client._server

    def uri(self, name: str) -> str:
        """The name of a file in the protocol; that of what is no file stays."""
        return name if ":" in name else (self.folder / name).as_uri()

    def open(self, name: str, text: str, version: int = 1) -> None:
        """Open a file with a text that need not be that on the disk."""
        t = self.types
        self.opened.add(self.uri(name))
        self.client.text_document_did_open(t.DidOpenTextDocumentParams(t.TextDocumentItem(self.uri(name), "scenic", version, text)))

    def change(self, name: str, text: str, version: int) -> None:
        """Type."""
        t = self.types
        document = t.VersionedTextDocumentIdentifier(version, self.uri(name))
        self.client.text_document_did_change(t.DidChangeTextDocumentParams(document, [t.TextDocumentContentChangeWholeDocument(text)]))

    def save(self, name: str) -> None:
        """Save."""
        t = self.types
        self.client.text_document_did_save(t.DidSaveTextDocumentParams(t.TextDocumentIdentifier(self.uri(name))))

    def close(self, name: str) -> None:
        """Close a file."""
        t = self.types
        self.opened.discard(self.uri(name))
        self.client.text_document_did_close(t.DidCloseTextDocumentParams(t.TextDocumentIdentifier(self.uri(name))))

    def until(self, condition: Callable[[], bool]) -> None:
        """Wait for something, for as long as it takes."""

        async def waiting() -> None:
            while not condition():
                assert self.server.returncode is None, "the server ended"
                await asyncio.sleep(0.01)

        self.do(waiting())

    def problems(self, name: str, version: int | None = 1, after: int = 0) -> list[Problem]:
        """The diagnostics of a version of a file, once they come; those that came after so many other messages."""
        uri = self.uri(name)
        self.until(lambda: any(p.uri == uri and p.version == version for p in self.published[after:]))
        found = [p for p in self.published[after:] if p.uri == uri and p.version == version][-1]
        return [Problem(int(d.severity or 0), d.message, str(d.code), of_range(d.range)) for d in found.diagnostics]

    def checked(self, name: str, text: str, version: int = 1) -> list[Problem]:
        """Open a file, and what is wrong with it."""
        self.open(name, text, version)
        return self.problems(name, version)

    def at(self, name: str, text: str) -> dict[str, Any]:
        """Open a text without its `|`, and where that was, for a program all in UTF-16."""
        before, _, after = text.partition("|")
        self.open(name, before + after)
        line = before.replace("\r\n", "\n").count("\n")
        character = len(before.rpartition("\n")[2].encode("utf-16-le")) // 2
        return {"text_document": self.types.TextDocumentIdentifier(self.uri(name)), "position": self.types.Position(line, character)}

    def hover(self, text: str, name: str = "main.scenic") -> tuple[str, tuple[int, int, int, int]] | None:
        """The Markdown at the `|`, and what it is about."""
        found = self.do(self.client.text_document_hover_async(self.types.HoverParams(**self.at(name, text))))
        return None if found is None else (found.contents.value, of_range(found.range))

    def complete(self, text: str, name: str = "main.scenic", typed: str | None = None) -> dict[str, Any]:
        """The suggestions at the `|` by what they insert; `typed` is the character that asks for them."""
        t = self.types
        context = None if typed is None else t.CompletionContext(t.CompletionTriggerKind.TriggerCharacter, typed)
        found = self.do(self.client.text_document_completion_async(t.CompletionParams(**self.at(name, text), context=context)))
        return {item.label: item for item in found.items}

    def definitions(self, text: str, name: str = "main.scenic") -> list[tuple[str, tuple[int, int, int, int]]]:
        """Where the name at the `|` is defined: files, and ranges in them."""
        found = self.do(self.client.text_document_definition_async(self.types.DefinitionParams(**self.at(name, text))))
        return [(location.uri.rpartition("/")[2], of_range(location.range)) for location in found]

    def goodbye(self) -> tuple[int, str]:
        """Shut the server down: its exit code, and what it said on standard error."""

        async def leave() -> tuple[int, str]:
            if self.server.returncode is None:
                await self.client.shutdown_async(None)
                self.client.exit(None)
            said = await self.server.stderr.read()
            code = await self.server.wait()
            await self.client.stop()
            return code, said.decode()

        return self.do(leave())


    def forget(self) -> None:
        """Close what is open, and remove all files."""
        for uri in list(self.opened):
            before = len(self.published)
            self.close(uri)
            self.until(lambda: any(p.uri == uri and p.version is None for p in self.published[before:]))  # noqa: B023 (called at once)
        self.published.clear()
        for path in self.folder.iterdir():
            path.unlink()


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Editor]:
    """An editor with a server, which has to end well."""
    found = Editor(tmp_path_factory.mktemp("programs"))
    yield found
    assert found.goodbye() == (0, "")
    found.loop.close()


@pytest.fixture
def editor(shared: Editor) -> Iterator[Editor]:
    """The editor with no file open, in an empty folder."""
    yield shared
    shared.forget()
