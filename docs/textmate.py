"""Writes docs/scenic.tmLanguage.json, a TextMate grammar for editors, from the terminals of the parser's grammar."""

from __future__ import annotations

import json
from pathlib import Path

from scenic_ref.interpreter.language.keywords import keywords, pattern
from scenic_ref.semantics.python.builtins import BUILTINS
from scenic_ref.semantics.store.built_in_classes import BUILT_IN_CLASSES

HERE = Path(__file__).with_name("scenic.tmLanguage.json")
SCOPES = {
    "keyword": "keyword.control.scenic", "statement": "keyword.control.statement.scenic", "constant": "constant.language.scenic",
    "specifier": "keyword.other.specifier.scenic", "operator": "keyword.operator.word.scenic",
}
"""What the kinds of words are to an editor."""
DEFINITION = r"\b(def|behavior|monitor|scenario)[ \t]+([^\W\d]\w*)(?=[ \t]*[(:])"


def grammar() -> dict[str, object]:
    """The grammar; TextMate looks at one line at a time, so that texts over several lines have a beginning and an end."""
    escapes = [{"name": "constant.character.escape.scenic", "match": r"\\."}]
    texts = [
        {"name": "string.quoted.triple.scenic", "begin": rf"(?i:[rbuf]{{0,2}}){quote}", "end": quote, "patterns": escapes} for quote in ('"""', "'''")
    ]
    one_line = "string.quoted.scenic"
    texts += [{"name": one_line, "begin": rf"(?i:[rbuf]{{0,2}}){quote}", "end": f"{quote}|$", "patterns": escapes} for quote in ('"', "'")]
    function, type_ = {"name": "entity.name.function.scenic"}, {"name": "entity.name.type.scenic"}
    keyword, property_ = {"name": "keyword.control.scenic"}, {"name": "variable.other.property.scenic"}
    words = [{"name": SCOPES[word.kind], "match": word.pattern} for word in keywords()]
    patterns = [
        {"name": "comment.line.number-sign.scenic", "match": "#.*$"},
        *texts,
        {"match": DEFINITION, "captures": {"1": keyword, "2": function}},
        {"match": r"\b(class)[ \t]+([^\W\d]\w*)", "captures": {"1": keyword, "2": type_}},
        {"match": r"\b(with)[ \t]+([^\W\d]\w*)(?=[ \t]+[^\s=,)])", "captures": {"1": {"name": SCOPES["specifier"]}, "2": property_}},
        {"match": r"\.([^\W\d]\w*)", "captures": {"1": property_}},
        *words,
        {"name": "variable.language.scenic", "match": r"\b(?:ego|self|workspace)\b"},
        {"name": "support.class.scenic", "match": rf"\b(?:{'|'.join(BUILT_IN_CLASSES)})\b"},
        {"name": "support.function.scenic", "match": rf"\b(?:{'|'.join(sorted(sorted(BUILTINS), key=len, reverse=True))})\b"},
        {"name": "constant.numeric.scenic", "match": rf"(?<!\w)(?:{pattern('NUMBER')})"},
    ]
    return {"name": "Scenic", "scopeName": "source.scenic", "fileTypes": ["scenic"], "patterns": patterns}


def grammar_json() -> str:
    """Return the grammar of TextMate as JSON."""
    return json.dumps(grammar(), indent=2, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    HERE.write_text(grammar_json(), encoding="utf-8")
