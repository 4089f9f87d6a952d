"""Where files are kept between processes."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def cache_place() -> Path:
    """The folder of this project in the user's cache directory, there or not. Raises `RuntimeError` where the user has no home."""
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local", "scenic-ref")
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache", "scenic-ref")


def cache_folder() -> Path | None:
    """The same, made if need be; None where nothing can be written."""
    try:
        folder = cache_place()
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, RuntimeError):
        return None
    return folder if os.access(folder, os.W_OK) else None
