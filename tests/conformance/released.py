"""Is every `scenic-2.1` and `scenic-3` text of the vectors a program of that release? Its parser is asked, by a Python with the release installed.

`python released.py scenic-3 PYTHON` exits with 1 and says which texts that release cannot parse; `make nightly` asks both. Vectors of
syntax errors are left out.
"""

from __future__ import annotations

import json
import subprocess
import sys

from scenic_ref.conformance import load_vectors
from scenic_ref.conformance.matchers.errors import Error

ASK = """
import json, sys
{parser}
found = {{}}
for name, text in json.load(sys.stdin).items():
    try:
        parse(text)
    except Exception as error:
        found[name] = f"{{type(error).__name__}}: {{error}}"
json.dump(found, sys.stdout)
"""
PARSERS = {
    "scenic-3": """
from scenic.syntax.parser import parse_string
def parse(text): parse_string(text, "exec")
""",
    # 2.1 parses a block of statements when those before it have run: without running any, the classes that imports bring must be told
    "scenic-2.1": """
import io, tokenize
from scenic.syntax import translator, veneer
def parse(text):
    blocks = translator.partitionByImports(list(tokenize.tokenize(io.BytesIO(text.encode()).readline)))
    known = [translator.Constructor(name, ("Object",)) for name in {of_worlds!r} if "import" in text]
    namespace = {{}}
    veneer.activate({{}}, None, "text", namespace)
    try:
        for block in blocks:
            source, made = translator.TokenTranslator(known, "text").translate(block)
            first = max(1, block[0][2][0])
            source = "\\n" * (first - 1) + source[2 * (first - 1):]
            tree, _ = translator.translateParseTree(translator.parseTranslatedSource(source, "text"), made, "text")
            translator.compileTranslatedTree(tree, "text")
            known = [c for name, c in made.items() if name not in translator.builtinConstructors]
    finally:
        veneer.deactivate()
""",
}
OF_WORLDS = ("Car", "EgoCar", "Bus", "Compact", "Rover", "Goal", "Rock", "BigRock", "Pipe")


def texts(dialect: str) -> dict[str, str]:
    """The texts that must be programs of a dialect, by the names of their vectors."""
    vectors = [v for v in load_vectors() if not (isinstance(v.matcher, Error) and "parse" in v.matcher.phases)]
    return {v.name: v.texts[dialect] for v in vectors if dialect in v.texts}


def refused(dialect: str, python: str) -> dict[str, str]:
    """Those that the release in that environment cannot parse, and its words."""
    program = ASK.format(parser=PARSERS[dialect].format(of_worlds=OF_WORLDS))
    answer = subprocess.run([python, "-c", program], input=json.dumps(texts(dialect)), capture_output=True, text=True, check=True)
    return json.loads(answer.stdout)


if __name__ == "__main__":
    dialect, python = sys.argv[1:]
    found = refused(dialect, python)
    for name, words in found.items():
        print(f"{name}: {words}")
    print(f"{len(texts(dialect)) - len(found)} of {len(texts(dialect))} texts are {dialect}")
    sys.exit(1 if found else 0)
