"""The language server: what `pygls` hears from the editor, and what it answers."""

from __future__ import annotations

import asyncio
import os
import threading
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO
from urllib.parse import unquote

from lsprotocol import types
from pygls.io_ import StdinAsyncReader, StdoutWriter, run_async
from pygls.lsp.server import LanguageServer
from pygls.uris import from_fs_path, to_fs_path
from pygls.workspace import TextDocument

from .. import __version__
from ..semantics.store.errors import UsageError
from .completion import Completion, suggestions
from .definitions import DefinedAt, targets
from .hover import hover
from .live_checks import DELAY, CheckingQueue, Records, Revision
from .module_library import LONGEST, ModuleShelf, SourceModule
from .name_scopes import NameFinder
from .outline import Definition, outline
from .positions import TextLines

SOURCE = "scenic-ref"
NO_EGO = "T-Mutate"
"""The rule that a program without an ego breaks; modules are such programs, and need none."""
SEVERITIES = {
    "error": types.DiagnosticSeverity.Error, "warning": types.DiagnosticSeverity.Warning, "information": types.DiagnosticSeverity.Information,
}
ITEMS = {
    "class": types.CompletionItemKind.Class, "distribution": types.CompletionItemKind.Constructor, "function": types.CompletionItemKind.Function,
    "behavior": types.CompletionItemKind.Function, "monitor": types.CompletionItemKind.Function, "scenario": types.CompletionItemKind.Module,
    "method": types.CompletionItemKind.Method, "property": types.CompletionItemKind.Property, "variable": types.CompletionItemKind.Variable,
    "parameter": types.CompletionItemKind.Variable, "module": types.CompletionItemKind.Module, "keyword": types.CompletionItemKind.Keyword,
}
SYMBOLS = {
    "class": types.SymbolKind.Class, "function": types.SymbolKind.Function, "behavior": types.SymbolKind.Function,
    "monitor": types.SymbolKind.Function, "scenario": types.SymbolKind.Module, "variable": types.SymbolKind.Variable,
    "property": types.SymbolKind.Property, "param": types.SymbolKind.Constant,
}


class ScenicServer(LanguageServer):
    """A language server for Scenic programs, which are checked under a limit of seconds.

    Texts are sent whole: pygls counts more ends of lines than the protocol knows, and would lose its place in some texts.
    """

    def __init__(self, seconds: float) -> None:
        super().__init__(SOURCE, __version__, text_document_sync_kind=types.TextDocumentSyncKind.Full)
        self.checks = CheckingQueue(seconds, self.publish)

    # -- Texts

    def opened(self, uri: str) -> TextDocument | None:
        """An open document. From 2.1 on pygls knows it by its address with the percent signs taken out, before by that which the editor gave."""
        documents = self.workspace.text_documents
        return documents.get(unquote(uri)) or documents.get(uri)

    def text_of(self, uri: str) -> TextDocument | None:
        """An open document, unless it is too long to look into."""
        found = self.opened(uri)
        return found if found is not None and len(found.source) <= LONGEST else None

    def lines(self, text: str) -> TextLines:
        """A text with places as the editor counts them."""
        return TextLines(text, str(getattr(self.workspace.position_encoding, "value", self.workspace.position_encoding)))

    def finder(self, document: TextDocument) -> NameFinder:
        """Return the finder of names in a document; it reads other open modules as they are in the editor."""
        opened = {os.path.realpath(d.path): d for d in self.workspace.text_documents.values() if to_fs_path(d.uri) is not None}

        def text(path: Path) -> str | None:
            found = opened.get(os.path.realpath(path))
            return None if found is None else found.source

        path = to_fs_path(document.uri)
        name = Path(path).stem if path is not None else document.uri
        return NameFinder(ModuleShelf(text), SourceModule(name, None if path is None else Path(path), document.source))

    # -- Diagnostics

    def check(self, uri: str, delay: float = DELAY) -> None:
        """Check an open document soon."""
        document = self.opened(uri)
        if document is not None:
            uri = document.uri
            path = to_fs_path(uri)
            folder = None if path is None else str(Path(path).parent)
            self.checks.changed(Revision(uri, document.version, document.source, path or uri, folder), delay)

    def publish(self, text: Revision, found: Records) -> None:
        """Tell the editor what was found wrong with a text."""
        shown = [self.diagnostic(text, record) for record in found]
        self.text_document_publish_diagnostics(types.PublishDiagnosticsParams(text.uri, shown, text.version))

    def diagnostic(self, text: Revision, record: dict[str, object]) -> types.Diagnostic:
        """An error or warning; one in a module stands at the statement that imports it, one without a place at the beginning."""
        elsewhere = record["file"] != text.file
        lines = self.lines(text.text)
        if elsewhere:
            start, end = self.importing(text, str(record["file"]))
        elif "line" in record:
            start, end = (lines.index(int(str(record[f"{which}line"])), int(str(record[f"{which}column"]))) for which in ("", "end_"))
        else:
            start, end = 0, lines.stops[0]
        message = "\n".join(str(part) for part in (record["message"], expected_tokens_text(record), record["hint"]) if part)
        severity = "information" if record["rule"] == NO_EGO and ("line" not in record or is_bare(text.text)) else str(record["severity"])
        return types.Diagnostic(
            editor_range(lines, start, max(end, start)), f"{diagnostic_place(record)}: {message}" if elsewhere else message, SEVERITIES[severity],
            code=str(record["rule"] or record["kind"]), source=SOURCE,
        )

    def importing(self, text: Revision, file: str) -> tuple[int, int]:
        """The statement that imports a module, as far as can be told, else the first line."""
        shelf = ModuleShelf(lambda path: None)
        main = SourceModule("", Path(text.file) if text.folder is not None else None, text.text)
        imports = [d for d in outline(text.text).children if d.kind == "import"]
        for one in imports:
            module = shelf.find(one.module, one.level, main)
            if module is not None and file in (str(module.path), f"<{module.name}>"):
                return one.first, one.last
        return (imports[0].first, imports[0].last) if imports else (0, self.lines(text.text).stops[0])

    # -- Answers

    def hover_at(self, params: types.HoverParams) -> types.Hover | None:
        """Return the hover text for the word under the pointer."""
        document = self.text_of(params.text_document.uri)
        if document is None:
            return None
        lines = self.lines(document.source)
        shown = hover(self.finder(document), lines.offset(params.position.line, params.position.character))
        if shown is None:
            return None
        return types.Hover(types.MarkupContent(types.MarkupKind.Markdown, shown.markdown), editor_range(lines, shown.start, shown.end))

    def completions_at(self, params: types.CompletionParams) -> types.CompletionList:
        """Return the completions at a place; after a typed space, only the likely ones."""
        document = self.text_of(params.text_document.uri)
        if document is None:
            return types.CompletionList(False, [])
        lines = self.lines(document.source)
        offset = lines.offset(params.position.line, params.position.character)
        unasked = params.context is not None and params.context.trigger_character == " "
        found = suggestions(self.finder(document), offset, unasked=unasked)
        return types.CompletionList(False, [item(one, number, lines, offset) for number, one in enumerate(found)])

    def definitions_at(self, params: types.DefinitionParams) -> list[types.Location]:
        """Return the places at which the name at a place is defined."""
        document = self.text_of(params.text_document.uri)
        if document is None:
            return []
        offset = self.lines(document.source).offset(params.position.line, params.position.character)
        return [self.location(document.uri, target) for target in targets(self.finder(document), offset)]

    def location(self, uri: str, target: DefinedAt) -> types.Location:
        """A stretch of a file; a file that is open has the name by which it was opened."""
        if target.path is not None:
            real = os.path.realpath(target.path)
            open_ = (d.uri for d in self.workspace.text_documents.values() if os.path.realpath(d.path) == real)
            uri = next(open_, None) or from_fs_path(str(target.path)) or uri
        return types.Location(uri, editor_range(self.lines(target.text), target.start, target.end))

    def symbols_of(self, params: types.DocumentSymbolParams) -> list[types.DocumentSymbol]:
        """The outline of a document."""
        document = self.text_of(params.text_document.uri)
        return [] if document is None else list(symbols(outline(document.source), self.lines(document.source)))


def editor_range(lines: TextLines, start: int, end: int) -> types.Range:
    """A stretch of a text, as the editor counts."""
    return types.Range(types.Position(*lines.place(start)), types.Position(*lines.place(end)))


def expected_tokens_text(record: dict[str, object]) -> str:
    """Return a text that lists the tokens the parser expected, or ""."""
    found = record["expected"]
    return f"expected {', '.join(map(str, found))}" if isinstance(found, list) and found else ""


def diagnostic_place(record: dict[str, object]) -> str:
    """The place of a diagnostic in another file."""
    return f"{Path(str(record['file'])).name}:{record['line']}:{record['column']}" if "line" in record else Path(str(record["file"])).name


def item(one: Completion, number: int, lines: TextLines, offset: int) -> types.CompletionItem:
    """A suggestion; the order is ours."""
    markdown = types.MarkupContent(types.MarkupKind.Markdown, one.markdown) if one.markdown else None
    return types.CompletionItem(
        one.label, kind=ITEMS.get(one.kind, types.CompletionItemKind.Text), detail=one.detail or None, documentation=markdown,
        sort_text=f"{number:05}", filter_text=one.label, text_edit=types.TextEdit(editor_range(lines, one.start, offset), one.label),
    )  # fmt: skip


def symbols(definition: Definition, lines: TextLines) -> Iterator[types.DocumentSymbol]:
    """Yield the symbols in a definition, each variable once, without imports and parameters."""
    seen: set[str] = set()
    for one in definition.children:
        if one.kind in SYMBOLS and one.name and not (one.kind == "variable" and one.name in seen):
            seen.add(one.name)
            name, whole = editor_range(lines, one.start, one.end), editor_range(lines, min(one.first, one.start), max(one.last, one.end))
            yield types.DocumentSymbol(one.name, SYMBOLS[one.kind], whole, name, detail=one.kind, children=list(symbols(one, lines)))


def is_bare(text: str) -> bool:
    """Whether a text has nothing but comments."""
    return all(not line or line.startswith("#") for line in map(str.strip, text.splitlines()))


def make_server(seconds: float) -> ScenicServer:
    """The server, ready to be started."""
    server = ScenicServer(seconds)

    @server.feature(types.TEXT_DOCUMENT_DID_OPEN)
    def did_open(params: types.DidOpenTextDocumentParams) -> None:
        server.check(params.text_document.uri, 0)

    @server.feature(types.TEXT_DOCUMENT_DID_CHANGE)
    def did_change(params: types.DidChangeTextDocumentParams) -> None:
        server.check(params.text_document.uri)

    @server.feature(types.TEXT_DOCUMENT_DID_SAVE)
    def did_save(params: types.DidSaveTextDocumentParams) -> None:
        for document in list(server.workspace.text_documents.values()):  # others may import it
            server.check(document.uri)

    @server.feature(types.TEXT_DOCUMENT_DID_CLOSE)
    def did_close(params: types.DidCloseTextDocumentParams) -> None:
        server.checks.dropped(params.text_document.uri)
        server.text_document_publish_diagnostics(types.PublishDiagnosticsParams(params.text_document.uri, []))

    @server.feature(types.INITIALIZED)
    def initialized(params: types.InitializedParams) -> None:
        server.checks.begin()

    @server.feature(types.SHUTDOWN)
    def shut_down(*_: object) -> None:
        server.checks.stop()

    server.feature(types.TEXT_DOCUMENT_HOVER)(lambda params: server.hover_at(params))
    server.feature(types.TEXT_DOCUMENT_COMPLETION, types.CompletionOptions([".", " "]))(lambda params: server.completions_at(params))
    server.feature(types.TEXT_DOCUMENT_DEFINITION)(lambda params: server.definitions_at(params))
    server.feature(types.TEXT_DOCUMENT_DOCUMENT_SYMBOL)(lambda params: server.symbols_of(params))
    return server


def serve_editor(stdin: BinaryIO, stdout: BinaryIO, seconds: float) -> None:
    """Speak to an editor by two streams, until it says good-bye or closes them; `SystemExit` 1, as the protocol wants it, for `exit` alone."""
    server = make_server(seconds)
    server.protocol.set_writer(StdoutWriter(stdout))
    try:
        asyncio.run(converse(server, StdinAsyncReader(stdin, server.thread_pool)))
    except (BrokenPipeError, KeyboardInterrupt):
        pass
    finally:
        server.shutdown()


async def converse(server: ScenicServer, reader: StdinAsyncReader | ProtocolReader) -> None:
    """Answer what is heard, until nothing is heard any more or the editor says good-bye; then end what checks programs."""
    try:
        await run_async(stop_event=threading.Event(), reader=reader, protocol=server.protocol, error_handler=server.report_server_error)
    finally:
        await server.checks.end()


class ProtocolReader:
    """A connection of which only one that speaks the protocol is heard: the request of a web page, say, begins otherwise."""

    def __init__(self, stream: asyncio.StreamReader) -> None:
        self.stream = stream
        self.begun = False

    async def readline(self) -> bytes:
        """The next line; nothing, as at the end, if the first one is no header of the protocol or the connection is broken."""
        line = b""
        with suppress(OSError, ValueError):
            line = await self.stream.readline()
        self.begun = self.begun or line.startswith(b"Content-")
        return line if self.begun else b""

    async def readexactly(self, n: int) -> bytes:
        """So many bytes; nothing if the connection ends before."""
        with suppress(OSError, asyncio.IncompleteReadError):
            return await self.stream.readexactly(n)
        return b""


async def serve_tcp(port: int, seconds: float) -> None:
    """Speak to the first that connects to a port of this machine, from this machine, until it goes. Raises `UsageError`."""
    server, connected = make_server(seconds), asyncio.get_running_loop().create_future()

    def connect(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        if connected.done():
            writer.close()
        else:
            connected.set_result((reader, writer))

    try:
        listening = await asyncio.start_server(connect, "127.0.0.1", port)
    except OSError as problem:
        raise UsageError(f"port {port} cannot be used: {problem.strerror or problem}") from None
    async with listening:
        reader, writer = await connected
    server.protocol.set_writer(writer)
    await converse(server, ProtocolReader(reader))
