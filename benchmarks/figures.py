"""The figures of a benchmark: what was measured, medians, ratios, geometric means, and all of it as JSON."""

from __future__ import annotations

import math
import os
import platform
import statistics
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

SCHEMA = "scenic-ref/bench/1"
KEPT = ("scenes", "attempts", "seconds", "drawing")
"""What is written of each sample."""
TIMES = ("seconds", "drawing")
"""What of it is rounded."""
PACKAGES = ("numpy", "scipy", "shapely", "numba", "llvmlite", "torch")


@dataclass
class Cell:
    """One program by one implementation: what preparing took, what was drawn each time, or why it was not."""

    program: str
    contender: str
    ready: dict[str, Any] = field(default_factory=dict)
    samples: list[dict[str, Any]] = field(default_factory=list)
    skipped: str | None = None

    def take(self, answer: dict[str, Any]) -> None:
        """An answer to the request for scenes."""
        if "skipped" in answer:
            self.skipped = str(answer["skipped"])
        else:
            self.samples.append(answer)

    @property
    def rates(self) -> list[float]:
        """Scenes per second of the processor, each time."""
        return [s["scenes"] / s["seconds"] for s in self.samples]

    @property
    def rate(self) -> float | None:
        """The median of the rates."""
        return statistics.median(self.rates) if self.samples else None

    @property
    def attempts(self) -> float | None:
        """Attempts per scene, all times together; None if they were not counted."""
        if not self.samples or "attempts" not in self.samples[0]:
            return None
        return sum(s["attempts"] for s in self.samples) / sum(s["scenes"] for s in self.samples)

    @property
    def prepare(self) -> float | None:
        """The seconds before the first scene."""
        starts = [s["start"] for s in self.samples if "start" in s]
        return statistics.median(starts) if starts else self.ready.get("prepare")

    @property
    def peak(self) -> float | None:
        """The most memory of its process, in MiB."""
        return max(s.get("peak", 0) for s in self.samples) / 2**20 if self.samples else None

    def json(self) -> dict[str, object]:
        """Return all figures of the cell as JSON."""
        found: dict[str, object] = {"program": self.program, "implementation": self.contender}
        if self.samples:
            found |= {
                "scenes per second": {"median": round_figure(self.rate), "min": round_figure(min(self.rates)), "max": round_figure(max(self.rates))},
                "attempts per scene": round_figure(self.attempts), "prepare seconds": round_figure(self.prepare),
                "prepare parts": {name: round_figure(value) for name, value in self.ready.get("parts", {}).items()},
                "peak MiB": round_figure(self.peak), "scenes per block": self.samples[-1].get("block", 1),
                "samples": [{k: round_figure(s[k]) if k in TIMES else s[k] for k in KEPT if k in s} for s in self.samples],
            }
            if "numbers" in self.ready:
                found["numbers per scene"] = self.ready["numbers"]
        return found | ({"skipped": self.skipped} if self.skipped is not None else {})


@dataclass(frozen=True, slots=True)
class WritingCost:
    """The seconds of the processor for drawing a scene and for all else of the same runs, and the numbers that it has in a table."""

    drawing: float
    writing: float
    numbers: float

    @property
    def share(self) -> float:
        """The cost of writing divided by that of drawing."""
        return self.writing / self.drawing

    @property
    def per_number(self) -> float:
        """Nanoseconds that writing takes for a number."""
        return 1e9 * self.writing / self.numbers

    def json(self) -> dict[str, object]:
        """Return all figures as JSON."""
        return {
            "drawing us/scene": round_figure(1e6 * self.drawing), "writing us/scene": round_figure(1e6 * self.writing),
            "writing/drawing": round_figure(self.share),
            "ns per number": round_figure(self.per_number),
        }


@dataclass
class Figures:
    """All cells of a benchmark, in the order in which they were measured. Ratios are to `standard`."""

    contenders: tuple[str, ...]
    standard: str
    cells: list[Cell] = field(default_factory=list)
    growth: dict[str, list[Cell]] = field(default_factory=dict)
    load: dict[str, tuple[float, ...]] = field(default_factory=dict)
    interrupted: bool = False
    what: str = "scenes"
    """The name of the unit that rates count: scenes, or time steps of simulations."""

    def programs(self) -> list[str]:
        """The programs with which the benchmark has begun."""
        return list(dict.fromkeys(cell.program for cell in self.cells))

    def unmeasured(self) -> list[str]:
        """The programs that no implementation could draw."""
        return [name for name in self.programs() if all(cell.rate is None for cell in self.cells if cell.program == name)]

    def cell(self, program: str, contender: str) -> Cell | None:
        """The cell of a program and an implementation."""
        return next((cell for cell in self.cells if (cell.program, cell.contender) == (program, contender)), None)

    def ratio(self, cell: Cell) -> float | None:
        """How many times the scenes per second of the standard; None if either is missing."""
        other = self.cell(cell.program, self.standard)
        if cell.rate is None or other is None or other.rate is None:
            return None
        return cell.rate / other.rate

    def writing(self, cell: Cell) -> WritingCost | None:
        """Return the cost of writing a file beside drawing; None for a command that only draws, and where the
        interpreter draws.
        """
        if not any(sample.get("drawing") for sample in cell.samples):
            return None
        drawing = statistics.median(sample["drawing"] / sample["scenes"] for sample in cell.samples)
        writing = statistics.median((sample["seconds"] - sample["drawing"]) / sample["scenes"] for sample in cell.samples)
        return WritingCost(drawing, writing, cell.ready["numbers"])

    def means(self) -> dict[str, tuple[float, int]]:
        """The geometric mean of an implementation's ratios, and over how many programs it goes."""
        found = {}
        for contender in self.contenders:
            ratios = [r for cell in self.cells if cell.contender == contender and (r := self.ratio(cell)) is not None]
            if ratios:
                found[contender] = (statistics.geometric_mean(ratios), len(ratios))
        return found

    def json(self, options: Mapping[str, object]) -> dict[str, object]:
        """All of it, with the machine that it was measured on."""
        cells = [cell.json() | {"ratio": round_figure(self.ratio(cell))} | (w.json() if (w := self.writing(cell)) else {}) for cell in self.cells]
        cells = [{name.replace("scenes", self.what): value for name, value in cell.items()} for cell in cells]
        return {
            "schema": SCHEMA, "versions": versions(), "machine": machine(), "load": self.load, "options": dict(options),
            "interrupted": self.interrupted, "ratios to": self.standard, "counted": self.what,
            "geometric means": {name: {"ratio": round_figure(mean), "programs": count} for name, (mean, count) in self.means().items()},
            "cells": cells, "growth": {name: [cell.json() for cell in found] for name, found in self.growth.items()},
        }


def round_figure(value: float | None) -> float | None:
    """Round to six significant digits; None if the number is not finite."""
    return None if value is None or not math.isfinite(value) else float(f"{value:.6g}")


def load_averages() -> tuple[float, ...]:
    """How many processes waited for a processor in the last 1, 5 and 15 minutes, where the system tells."""
    return tuple(round(x, 2) for x in os.getloadavg()) if hasattr(os, "getloadavg") else ()


def versions() -> dict[str, str]:
    """The versions that decide how fast this package is."""
    from .. import __version__

    found = {"scenic-ref": __version__, "python": platform.python_version()}
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed"
    return found


def machine() -> dict[str, object]:
    """The processor and the system."""
    return {"system": platform.system(), "machine": platform.machine(), "processor": processor(), "processors": os.cpu_count()}


def processor() -> str:
    """The name of the processor, where the system tells."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), platform.processor())


def fit_exponent(points: Iterable[tuple[float, float]]) -> float | None:
    """The exponent p of the power law cost = c · size^p that fits best, on logarithms; None for fewer than two points."""
    logs: Sequence[tuple[float, float]] = [(math.log(x), math.log(y)) for x, y in points if x > 0 and y > 0]
    if len(logs) < 2:
        return None
    return statistics.linear_regression([x for x, _ in logs], [y for _, y in logs]).slope
