"""A finder that gives one module of the package as a mutant has it. This file stands alone: processes that tests start load it by its path."""

from __future__ import annotations

import marshal
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, SourceFileLoader
from importlib.util import spec_from_file_location
from pathlib import Path
from types import CodeType


class Mutated(MetaPathFinder, SourceFileLoader):
    """Finds and loads the module of that name and file with other code."""

    def __init__(self, name: str, file: str, code: CodeType) -> None:
        super().__init__(name, file)
        self.code = code

    @classmethod
    def kept(cls, path: str) -> Mutated:
        """What `keep` wrote."""
        return cls(*marshal.loads(Path(path).read_bytes()))

    def keep(self, path: str) -> None:
        """Write it for another process of this Python."""
        Path(path).write_bytes(marshal.dumps((self.name, self.path, self.code)))

    def find_spec(self, fullname: str, path: object = None, target: object = None) -> ModuleSpec | None:
        """The module's, None for another one."""
        if fullname != self.name:
            return None
        package = [str(Path(self.path).parent)] if self.path.endswith("__init__.py") else None
        return spec_from_file_location(fullname, self.path, loader=self, submodule_search_locations=package)

    def get_code(self, fullname: str) -> CodeType:
        """The other code; no file of compiled code is read or written."""
        return self.code
