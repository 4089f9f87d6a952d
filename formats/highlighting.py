"""Programs in colours: a lexer for Pygments, which finds it by the name `scenic` and by `*.scenic`."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import ClassVar

from pygments.lexer import RegexLexer, bygroups
from pygments.token import Comment, Keyword, Name, Number, Operator, Punctuation, String, Text, Whitespace

from ..interpreter.keywords import keywords, pattern
from ..semantics.kernel.classes import BUILT_IN_CLASSES
from ..semantics.python.builtins import BUILTINS

TOKENS: Mapping[str, object] = {
    "keyword": Keyword, "statement": Keyword, "constant": Keyword.Constant, "specifier": Keyword.Declaration, "operator": Operator.Word,
}
"""What the kinds of words are to Pygments."""


class ScenicLexer(RegexLexer):
    """Scenic programs in any of the dialects; its words are those of the grammar."""

    name = "Scenic"
    url = "https://scenic-lang.org"
    aliases: ClassVar[Sequence[str]] = ["scenic"]
    filenames: ClassVar[Sequence[str]] = ["*.scenic"]
    mimetypes: ClassVar[Sequence[str]] = ["text/x-scenic"]
    flags = re.MULTILINE

    tokens: ClassVar[dict[str, list[object]]] = {
        "root": [
            (r"\n", Whitespace),
            (r"[ \t\f]+", Whitespace),
            (pattern("COMMENT"), Comment.Single),
            (pattern("FSTRING"), String.Interpol),
            (pattern("STRING"), String),
            (r"(def|behavior|monitor|scenario)([ \t]+)([^\W\d]\w*)(?=[ \t]*[(:])", bygroups(Keyword, Whitespace, Name.Function)),
            (r"(class)([ \t]+)([^\W\d]\w*)", bygroups(Keyword, Whitespace, Name.Class)),
            (r"(with)([ \t]+)([^\W\d]\w*)(?=[ \t]+[^\s=,)])", bygroups(Keyword.Declaration, Whitespace, Name.Attribute)),
            (r"(\.)([^\W\d]\w*)", bygroups(Operator, Name.Attribute)),
            *((word.pattern, TOKENS[word.kind]) for word in keywords()),
            (r"(?:ego|self|workspace)\b", Name.Builtin.Pseudo),
            (rf"(?:{'|'.join(BUILT_IN_CLASSES)})\b", Name.Class),
            (rf"(?:{'|'.join(sorted(sorted(BUILTINS), key=len, reverse=True))})\b", Name.Builtin),
            (pattern("NUMBER"), Number),
            (r"[^\W\d]\w*", Name),
            (r"[-+*/%@&|^~<>=!]+", Operator),
            (r"[()\[\]{},:;.\\]", Punctuation),
            (r".", Text),
        ]
    }
