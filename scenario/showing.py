"""Scenarios at prompts and in notebooks."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..interpreter.language.dialects import DIALECTS
from ..pictures.notebook_views import line_of_program, page_of_program
from ..pictures.scene_figures import draw_scenes, size_of
from ..semantics.kernel.errors import UsageError
from ..semantics.readings import select
from .checking import check_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .scenario import Scenario

MOST = 100
"""Scenes in one picture."""


class Shown:
    """What makes a `Scenario` one that can be looked at."""

    def __repr__(self) -> str:
        return line_of(self)  # type: ignore[arg-type]

    def _repr_html_(self) -> str:
        """The text of the program, for notebooks: nothing is drawn, which could take long."""
        return page_of_program(line_of(self), self.program.text)  # type: ignore[arg-type, attr-defined]

    def plot(self, n: int = 9, seed: int = 0) -> Figure:
        """A new figure of `matplotlib.pyplot` with the first `n` scenes of `seed` (100 at most), seen from above in metres.

        Raises `UsageError` for other numbers and for coordinates that cannot be drawn, `AttemptsExhausted`, and the program's errors.
        """
        check_whole(("n", n, 1), ("seed", seed, None))
        return plotted(self, n, seed)  # type: ignore[arg-type]


def line_of(scenario: Scenario) -> str:
    """The scenario in one line, with the readings that are not those of its dialect."""
    usual = select(DIALECTS[scenario.program.dialect].profile)
    readings = {name: alternative for name, alternative in scenario.readings.items() if usual[name] != alternative}
    program = scenario.program
    return line_of_program(program.file, program.dialect, readings, scenario.params, given=scenario.conditioned_from is not None)


def plotted(scenario: Scenario, n: int, seed: int) -> Figure:
    """What `Shown.plot` returns. Raises as it does."""
    import matplotlib.pyplot as plt

    if n > MOST:
        raise UsageError(f"a picture holds {MOST} scenes at most, not {n:,}")
    scenes = list(scenario.sample_many(n, seed))
    rows, columns, side = size_of(n)
    figure = plt.figure(figsize=(columns * side, rows * (side + 0.3)), layout="constrained")
    draw_scenes(figure, scenes, None)
    return figure
