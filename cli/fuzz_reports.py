"""The reports of a campaign: a page, JUnit XML, the programs, and drafts of vectors."""

from __future__ import annotations

from base64 import b64encode
from collections import Counter
from collections.abc import Sequence
from html import escape
from importlib.resources import files
from pathlib import Path
from string import Template
from xml.etree import ElementTree

from ..conformance.fuzz.causes import Cause
from ..conformance.fuzz.examination import CampaignSettings, FuzzedProgram
from ..conformance.fuzz.triage import CampaignFindings, JudgedFinding, to_toml
from ..conformance.fuzz.vector_draft import draft_of
from ..pictures.side_by_side import side_by_side
from .output_paths import write

FINDINGS = "findings.toml"
VERDICTS = ("agree", "differ", "inconclusive", "skipped")


def write_reports(
    folder: Path, name: str, settings: CampaignSettings, examined: Sequence[FuzzedProgram], causes: Sequence[Cause],
    found: Sequence[JudgedFinding],
) -> None:
    """All reports of a campaign, over those of an earlier state of it. Raises `UsageError` if they cannot be written."""
    findings = folder / "findings"
    findings.mkdir(exist_ok=True)
    for old in (*findings.glob("*.scenic"), *findings.glob("*.toml")):
        old.unlink()
    for number, cause in enumerate(causes, 1):
        write(str(findings / f"{number:02}.scenic"), cause.smallest.minimal)
        draft = draft_of(cause, f"finding-{number:02}", settings)
        if draft is not None:
            write(str(findings / f"{number:02}.toml"), draft)
    write(str(folder / FINDINGS), to_toml(CampaignFindings(name, campaign_summary(settings, examined), list(found))))
    write(str(folder / "report.html"), page(name, settings, examined, causes, found))
    write(str(folder / "junit.xml"), junit(name, found, examined))


def page(
    name: str, settings: CampaignSettings, examined: Sequence[FuzzedProgram], causes: Sequence[Cause], found: Sequence[JudgedFinding]
) -> str:
    """The campaign as one self-contained page."""
    template = Template(files("scenic_ref.cli").joinpath("fuzz.html").read_text(encoding="utf-8"))
    readings = ", ".join(f"{id} = {alternative}" for id, alternative in settings.readings.items())
    rows = "\n".join(
        f'<tr><td class="number">{n}</td><td><a href="#cause-{n}">{escape(f.kind)}</a></td><td>{escape(f.words)}</td>'
        f'<td>{f.class_}</td><td class="number">{f.programs}</td></tr>'
        for n, f in enumerate(found, 1)
    )
    sections = "\n".join(cause_section(n, cause, f) for n, (cause, f) in enumerate(zip(causes, found, strict=True), 1))
    return template.substitute(
        title=escape(f"{name}: {len(causes)} causes of difference"), about=escape(campaign_summary(settings, examined)),
        readings=escape(f"Readings of both: {readings}." if readings else "Both were compared under the paper's readings."),
        rows=rows, causes=sections, others=escape(others(examined, causes)),
    )  # fmt: skip


def campaign_summary(settings: CampaignSettings, examined: Sequence[FuzzedProgram]) -> str:
    """How many programs there were, and how sure what was found is."""
    counts = Counter(found.verdict for found in examined)
    told = f"{len(examined):,} programs of seed {settings.seed}: " + ", ".join(f"{counts[verdict]:,} {verdict}" for verdict in VERDICTS)
    return f"{told}. The risk of one false alarm or more in all of it is at most {settings.alpha:g}."


def cause_section(number: int, cause: Cause, found: JudgedFinding) -> str:
    """A cause: the program, what differs, a picture where it can be seen, what was decided, where the paper says so."""
    reading = f"<p>They agree under {escape(found.reading)}.</p>" if found.reading else ""
    evidence = cause.smallest.evidence
    certain = "certain" if evidence is None else f"10^{evidence:.1f}"
    return (
        f'<section id="cause-{number}"><h2>{number}. {escape(found.kind)}: {escape(found.words)}</h2>'
        f"<pre>{escape(found.program)}</pre><p>{escape(found.detail)}</p>{reading}{scenes_image(found)}"
        f"<p><b>{escape(found.class_)}</b>{escape(f': {found.why}' if found.why else '')}</p>"
        f'<p class="dim">Evidence: {certain}. Rules: {escape(", ".join(cause.smallest.rules) or "none of its own")}. '
        f"The paper: {escape(found.passage)}. Programs: {first_numbers(cause.numbers)}.</p></section>"
    )


def scenes_image(found: JudgedFinding) -> str:
    """The scenes of both sides as a picture in the page, if the difference is one that can be seen."""
    if not found.here and not found.there:
        return ""
    picture = b64encode(side_by_side({"here": found.here, "there": found.there})).decode()
    return f'<p><img alt="scenes here and there" width="540" src="data:image/png;base64,{picture}"></p>'


def first_numbers(numbers: Sequence[int], most: int = 20) -> str:
    """The first of some numbers."""
    return ", ".join(map(str, numbers[:most])) + (" ..." if len(numbers) > most else "")


def others(examined: Sequence[FuzzedProgram], causes: Sequence[Cause]) -> str:
    """Describe the differing programs that belong to none of the causes."""
    told = {number for cause in causes for number in cause.numbers}
    alike = Counter(f"{e.kind}, {e.words}" for e in examined if e.verdict == "differ" and e.number not in told)
    return "; ".join(f"{count} more of: {words}" for words, count in alike.most_common()) or "None."


def junit(name: str, findings: Sequence[JudgedFinding], examined: Sequence[FuzzedProgram]) -> str:
    """The campaign as a suite with a test case for each cause, and one for the programs that agree."""
    suite = ElementTree.Element("testsuite", name="scenic-ref fuzz", tests=str(len(findings) + 1), failures=str(len(findings)), errors="0")
    agree = sum(found.verdict == "agree" for found in examined)
    ElementTree.SubElement(suite, "testcase", classname=name, name=f"{agree} programs agree")
    for number, found in enumerate(findings, 1):
        case = ElementTree.SubElement(suite, "testcase", classname=name, name=f"cause {number}: {found.kind}, {found.words}")
        ElementTree.SubElement(case, "failure", type=found.kind, message=found.words).text = f"{found.program}\n{found.detail}"
    ElementTree.indent(suite)
    return ElementTree.tostring(suite, encoding="unicode", xml_declaration=True) + "\n"
