"""The reports of `scenic-ref check --samples`: a page to look at, and JUnit XML for continuous integration."""

from __future__ import annotations

import math
from collections.abc import Mapping
from html import escape
from importlib.resources import files
from pathlib import Path
from string import Template
from xml.etree import ElementTree

from ..inference.comparison import Feature, Verdict
from ..inference.comparison.scene_columns import unit_of
from ..sampling.program_source import Source
from ..semantics.store.errors import UsageError
from .output_paths import check_place, write

MOST_DRAWN = 8
MOST_LISTED = 400
WIDTH, HEIGHT, FOOT, UNIT = 900, 130, 24, 14
MARGIN, TOP = 64, 8
"""What the axis of the shares takes at the left, and half the height of its uppermost number."""
LETTER, LONGEST = 5.2, 20
"""The width of a letter of a label, and how many letters a slanted one has at most."""


def check_report_paths(report: str | None, junit: str | None, read: Mapping[str, str | None]) -> None:
    """Find wrong paths before the work begins; `read` are the files that are read, by what they are. Raises `UsageError`."""
    for path, option, suffix in ((report, "--report", ".html"), (junit, "--junit", ".xml")):
        if path is None:
            continue
        if Path(path).suffix.lower() != suffix:
            raise UsageError(f"{option} {path}: the report is written as {suffix}")
        check_place(path, read)


def write_page(path: str, verdict: Verdict, source: Source, samples: str) -> None:
    """The comparison as one self-contained page."""
    template = Template(files("scenic_ref.cli").joinpath("check.html").read_text(encoding="utf-8"))
    about = f"{samples}, {verdict.n:,} scenes after {verdict.burned:,} that gave the cells; risk of a false alarm {verdict.alpha:g}"
    about += f"; {verdict.constants:,} features that no draw changes were compared exactly"
    rows = "\n".join(_row(feature) for feature in verdict.features[:MOST_LISTED])
    write(
        path,
        template.substitute(
            title=escape(f"{source.file}: {verdict.kind}"), about=escape(about), kind=verdict.kind,
            lines="".join(f"<p>{escape(line)}</p>" for line in verdict.lines()),
            expected="the exact law" if verdict.exact else "scenes of the program",
            skipped=escape(f"Not compared, since only one side has them: {', '.join(verdict.skipped)}." if verdict.skipped else ""),
            features="\n".join(_feature_chart(feature) for feature in verdict.features[:MOST_DRAWN]), rows=rows,
        ),
    )


def _row(feature: Feature) -> str:
    return (
        f'<tr><td><code>{escape(feature.name)}</code></td><td class="number">10^{feature.evidence:.1f}</td>'
        f'<td class="number">{feature.distance:.2%}</td><td class="number">{len(feature.counts)}</td></tr>'
    )


def _feature_chart(feature: Feature) -> str:
    """One feature: the frequencies of its cells, side by side, with the axis of the shares and the labels of the cells."""
    a, b = sum(feature.counts) or 1.0, sum(feature.others) or 1.0
    cells = [(label, x / a, y / b) for label, x, y in zip(feature.labels, feature.counts, feature.others, strict=True) if x or y]
    highest = max((max(x, y) for _, x, y in cells), default=1.0) or 1.0
    step = (WIDTH - MARGIN) / max(1, len(cells))
    slanted = any(len(label) * LETTER > step for label, _, _ in cells)
    bars = "".join(_bar(MARGIN + i * step, step, label, x, y, highest, slanted=slanted) for i, (label, x, y) in enumerate(cells))
    note = f"e-value 10^{feature.evidence:.1f}, total variation {feature.distance:.2%} in {len(cells)} cells (point at a bar for its numbers)"
    foot = 14 + 0.6 * LETTER * min(LONGEST, max(len(label) for label, _, _ in cells)) if slanted else FOOT
    name, units = escape(feature.name), [unit_of(part) for part in feature.name.split(" & ")]
    if all(units):
        foot += UNIT
        bars += f'<text x="{WIDTH}" y="{HEIGHT + foot - 4:.0f}" text-anchor="end">in {" and ".join(dict.fromkeys(units))}</text>'
    picture = f'<svg viewBox="0 {-TOP} {WIDTH} {HEIGHT + foot + TOP:.0f}" role="img" aria-label="{name}">{shares(highest)}{bars}</svg>'
    return f'<div class="feature"><h3>{name}</h3><p>{escape(note)}</p>{picture}</div>'


def shares(highest: float) -> str:
    """The axis of the shares, in round steps, with a line across for each."""
    step = 10.0 ** math.floor(math.log10(highest))
    step = next(step * k for k in (0.2, 0.25, 0.5, 1, 2) if highest / (step * k) <= 5)
    lines = []
    for k in range(math.floor(highest / step + 1e-9) + 1):
        y = HEIGHT * (1 - k * step / highest)
        lines.append(f'<line class="grid" x1="{MARGIN}" x2="{WIDTH}" y1="{y:.1f}" y2="{y:.1f}"/>')
        lines.append(f'<text x="{MARGIN - 6}" y="{y + 3.5:.1f}" text-anchor="end">{100 * k * step:g}%</text>')
    return "".join(lines)


def _bar(left: float, step: float, label: str, x: float, y: float, highest: float, *, slanted: bool) -> str:
    """The two bars of a cell, with its label; pointing at them shows the exact numbers."""
    width = step * 0.38
    tip = f"<title>{escape(label)}: {x:.3%} of the samples, {y:.3%} expected</title>"
    rects = "".join(
        f'<rect class="{name}" x="{left + step * 0.1 + k * width:.1f}" y="{HEIGHT * (1 - v / highest):.1f}" '
        f'width="{width:.1f}" height="{HEIGHT * v / highest:.1f}">{tip}</rect>'
        for k, (name, v) in enumerate((("one", x), ("other", y)))
    )
    middle = f'x="{left + step / 2:.1f}" y="{HEIGHT + 14}"'
    if not slanted:
        return f'{rects}<text {middle} text-anchor="middle">{escape(label)}</text>'
    text = label if len(label) <= LONGEST else f"{label[: LONGEST - 1]}\N{HORIZONTAL ELLIPSIS}"
    return f'{rects}<text {middle} text-anchor="end" transform="rotate(-35 {left + step / 2:.1f} {HEIGHT + 10})">{escape(text)}</text>'


def write_junit(path: str, verdict: Verdict, source: Source, samples: str) -> None:
    """The verdict as a suite of one test case: "different" is a failure, "inconclusive" an error."""
    failures, errors = (str(int(verdict.kind == kind)) for kind in ("different", "inconclusive"))
    suite = ElementTree.Element("testsuite", name="scenic-ref check", tests="1", failures=failures, errors=errors)
    case = ElementTree.SubElement(suite, "testcase", classname=source.file, name=f"{samples} has the distribution of {source.file}")
    if verdict.kind != "equivalent":
        kind = "failure" if verdict.kind == "different" else "error"
        ElementTree.SubElement(case, kind, type=verdict.kind, message=verdict.lines()[0]).text = str(verdict)
    else:
        ElementTree.SubElement(case, "system-out").text = str(verdict)
    ElementTree.indent(suite)
    write(path, ElementTree.tostring(suite, encoding="unicode", xml_declaration=True) + "\n")
