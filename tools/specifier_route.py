"""Print the files of the package between the grammar and the value of `left of X by Y`, in the order of the calls.

They are the grammar, the files on the stack where a node `BesideSpecifier` is made, the file of that node, and those on the stack where the
equation of `left of OBJECT` is evaluated.
"""

from __future__ import annotations

import sys
from pathlib import Path
from types import FrameType

from scenic_ref import loads
from scenic_ref.semantics.scenes.specifiers import left_of_object
from scenic_ref.semantics.syntax.specifiers import BesideSpecifier

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = "ego = Object at 0 @ 0\nObject left of ego by 1\n"


def main() -> None:
    """Print the files, one a line."""
    passed = {"interpreter/language/grammar.lark": None}

    def profile(frame: FrameType, event: str, _: object) -> None:
        if event != "call":
            return
        makes_node = frame.f_code is BesideSpecifier.__init__.__code__
        if makes_node or frame.f_code is left_of_object.__code__:
            stack = []
            current: FrameType | None = frame
            while current is not None:
                path = Path(current.f_code.co_filename).resolve()
                if path.is_relative_to(ROOT) and ".venv" not in path.parts and "tools" not in path.parts:
                    stack.append(str(path.relative_to(ROOT)))
                current = current.f_back
            passed.update(dict.fromkeys(reversed(stack)))
            if makes_node:
                passed["semantics/syntax/specifiers.py"] = None

    sys.setprofile(profile)
    scenario = loads(PROGRAM)
    scenario.sample(0)
    sys.setprofile(None)
    print(*passed, sep="\n")


if __name__ == "__main__":
    main()
