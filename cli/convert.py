"""`scenic-ref convert`: a program in another dialect."""

from __future__ import annotations

from typing import Annotated

import typer

from .options import DebugOption, DialectOption, FileArgument
from .shell_completion import dialects, words


def convert(
    context: typer.Context,
    file: FileArgument,
    to: Annotated[
        str,
        typer.Option(
            "--to", metavar="DIALECT", autocompletion=words(dialects), help="The dialect to write: paper, pldi19, scenic-2.1 or scenic-3."
        ),
    ],
    output: Annotated[str | None, typer.Option("-o", "--output", metavar="PATH", help="Write the program here.", show_default="stdout")] = None,
    dialect: DialectOption = None,
    debug: DebugOption = False,
) -> None:
    """Write a program in another dialect.

    Comments are kept, those inside of a statement above it; the layout is not. What the other dialect cannot say is an error, with its place.
    Only the spelling is converted: where the meaning differs, it is a matter of readings (`readings --profile scenic-3`).
    """
    from pathlib import Path

    from ..interpreter.language.conversion import convert as converted
    from ..interpreter.language.dialects import choose
    from ..interpreter.language.modules import library_of, read_text
    from ..interpreter.language.parser import parse
    from ..simulators.worlds import WORLDS
    from .output_paths import check_place, write

    choose("", to)  # there is such a dialect
    context.obj.program = file
    text = read_text(Path(file))
    context.obj.texts[file] = text
    if output is not None and output != "-":
        check_place(output, {"the program itself": file})
    program = parse(text, file, dialect)
    library = library_of(program, worlds=WORLDS, model=None, trust=False, directory=Path(file).parent, dialect=dialect)
    result = converted(program, to, library)
    if output is None or output == "-":
        print(result, end="")
    else:
        write(output, result)
