"""Writes docs/reference/: the pages that are generated from the code, so that they cannot be out of date."""

from __future__ import annotations

import re
import tomllib
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from textwrap import dedent

import scenic_ref
from code_pages import cell, command_pages, commands_page, constructors_page, paragraph
from contact_sheets import contact_sheet
from scenic_ref.conformance import load_vectors, results
from scenic_ref.conformance.fuzz.triage import CLASSES_OF_FINDINGS, JudgedFinding, shipped_findings
from scenic_ref.conformance.known_differences import CLASSES, KnownCause, causes, shipped_differences
from scenic_ref.conformance.listings import CompletedProgram, LineOrigin, complete_listings, read_manifest
from scenic_ref.conformance.measurements import measurements
from scenic_ref.conformance.picture_boxes import OURS, pictured_scenes
from scenic_ref.conformance.reports import shows
from scenic_ref.conformance.vector import ConformanceVector
from scenic_ref.pictures.map_figures import map_picture
from scenic_ref.pictures.side_by_side import side_by_side
from scenic_ref.roads import made_map
from scenic_ref.roads.map_generator import KINDS
from scenic_ref.semantics.machine import sandbox_table
from scenic_ref.semantics.readings import PROFILES, READINGS, Reading, always_decided
from scenic_ref.semantics.rules import CATALOGUE
from scenic_ref.semantics.theorems import THEOREMS

HERE = Path(__file__).parent / "reference"
PROOFS = Path(__file__).parents[1] / "proofs"
LISTINGS = Path(__file__).parents[1] / "examples" / "paper" / "dynamic"
THEOREM = re.compile(r"(?:\(\*\* (?!\*)(?P<comment>(?:(?!\*\)).)*)\*\)\s*)?^\s*Theorem (?P<name>\w+)", re.DOTALL | re.MULTILINE)
"""A theorem of Coq, with the comment right before it."""
WITHOUT_CONTENTS = "---\nhide: [toc]\n---\n"
"""Of pages whose tables need the place."""
MOST_NAMED, LONGEST_EXAMPLE = 3, 40
DEVIATIONS, FEW_LINES = ("bug", "missing", "unchecked"), 12
VALUES = "| parameter | default | values | meaning |\n| --- | --- | --- | --- |"


def item(text: str) -> str:
    """One entry of a list."""
    return paragraph(text, "- ", "  ")


def rules_page() -> str:
    """Every rule with its function and its vectors."""
    about = (
        "Every inference rule, equation and algorithm of the paper, under the paper's own name; then what is inherited from Python. The last "
        "column names [vectors](../vectors.md) that show the rule: it fires or refuses the program, and the result was worked out by hand. "
        "`scenic-ref conformance --vector NAME` runs one."
    )
    lines = [
        WITHOUT_CONTENTS, "# Rules, functions, tests", "", paragraph(about), "",
        "| rule | the paper's name or left-hand side | place in the paper | function | vectors |", "| --- | --- | --- | --- | --- |",
    ]
    named_by: dict[str, list[str]] = {}
    for vector in load_vectors():
        for rule in shows(vector):
            named_by.setdefault(rule, []).append(vector.name)
    for rule in CATALOGUE:
        names = named_by.get(rule.id, ["tests/semantics/test_resolution.py"])
        more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
        named = ", ".join(f"`{name}`" for name in names[:MOST_NAMED]) + more
        code = rule.code.replace(".", ".<wbr>")
        lines.append(f"| `{rule.id}` | {cell(rule.name)} | {cell(rule.place)} | <code>{code}</code> | {named} |")
    return "\n".join(lines) + "\n"


def proofs_page() -> str:
    """Every theorem of proofs/: its statement, where it stands, and the rules that it is about."""
    about = (
        "The theorems of `proofs/`, checked by Coq, theory by theory. Each has a sentence for a name; what it says is the statement below it, as Coq "
        "prints it, with all premises. They are proved of the theories: `proofs/README.md` tells from which assumptions, in what the theories "
        "differ from the program, and how tests tie the two. `scenic-ref rules R-Cyclic` names the theorems about a rule."
    )
    blocks = (block.partition("\n") for block in (PROOFS / "statements.txt").read_text().split("\n\n"))
    statements = {name: dedent(statement).rstrip() for name, _, statement in blocks}
    lines = ["# Theorems", "", paragraph(about)]
    for theory in (line for line in (PROOFS / "_CoqProject").read_text().splitlines() if line.endswith(".v")):
        lines += ["", f"## {theory}"]
        for theorem in THEOREM.finditer((PROOFS / theory).read_text()):
            lines += theorem_lines(theory, theorem, statements)
    return "\n".join(lines) + "\n"


def theorem_lines(theory: str, theorem: re.Match[str], statements: Mapping[str, str]) -> Iterator[str]:
    """One theorem, with the comment before it."""
    name, comment = theorem["name"], theorem["comment"]
    rules = ", ".join(f"`{rule}`" for rule, theories in THEOREMS.items() if name in theories.get(theory, ()))
    line = theorem.string.count("\n", 0, theorem.start("name")) + 1
    yield from ("", f"### `{name}`", "")
    yield paragraph(f"`proofs/{theory}`, line {line}" + (f"; about {rules}" if rules else "") + ".")
    if comment:
        yield from ("", paragraph(re.sub(r"\[(\w+)\]", r"`\1`", " ".join(comment.split()))))
    yield from ("", "```coq", statements[f"{theory.removesuffix('.v').replace('/', '.')}.{name}"], "```")


def readings_page() -> str:
    """Every reading with its alternatives and profiles."""
    notes = sum(reading.is_note for reading in READINGS.values())
    decided = ", ".join(f"`{name}`" for name in always_decided())
    lines = [
        "# Readings", "",
        paragraph(
            f"The paper contradicts itself or is silent in {len(READINGS)} places. Of these, {notes} are notes: they have one answer, under every "
            "profile. The others have alternatives: `--reading ID=ALTERNATIVE` selects one, `--profile` one of each."
        ), "",
        item("`paper` (default) sets an equation aside only where a definition, a table or a drawn figure of the same paper contradicts it."),
        item(
            "`formal` takes the formal rules to the letter wherever an alternative does. These conflicts have no such alternative, and are "
            f"decided alike under every profile: {decided}."
        ),
        item("`prose` lets the prose win; `scenic-2.1` and `scenic-3` do what the released implementations do."), "",
    ]
    for reading in READINGS.values():
        lines += [*reading_lines(reading), ""]
    return "\n".join([*lines, *measured_lines(), ""])


def measured_lines() -> Iterator[str]:
    """How the profiles of the releases were measured: a table, and what is strange in it."""
    found = measurements()
    versions = " and ".join(f"{version} (profile `{profile}`)" for profile, version in found.releases.items())
    heads = [f"{version}, {way}" for version in found.releases.values() for way in ("command line", "API", "ours")]
    yield from ("## How the profiles were measured", "")
    yield paragraph(
        f"Programs that tell the alternatives of a reading apart were given to {versions}, last on {found.date}, as users run them: to the "
        "command line, and to the API with its own defaults. The alternative of which a program passes is that of the release; `-` is "
        "neither, for the reason below. `scenic-ref conformance --vector NAME` runs the vectors here; those named `profile-...` are in "
        "`tools/profile_vectors.toml`, and `tools/measure_profiles.py` measures all anew."
    )
    yield from ("", f"| reading | vectors | {' | '.join(heads)} |", f"| --- | --- |{' --- |' * len(heads)}")
    for id, lines in found.readings.items():
        named = dict.fromkeys(name for line in lines.values() for name in line.vectors)
        told = [f"`{way}`" if way else "-" for line in lines.values() for way in (line.command_line, line.api, line.ours)]
        yield f"| [`{id}`](#{id}) | {', '.join(f'`{name}`' for name in named) or '-'} | {' | '.join(told)} |"
    yield ""
    for id, lines in found.readings.items():
        for profile, line in lines.items():
            said = " ".join(part for part in (line.differs, line.note, line.why) if part)
            if said:
                yield item(f"`{id}`, {found.releases[profile]}: {cell(said)}")


def reading_lines(reading: Reading) -> Iterator[str]:
    """Yield the lines of the section on one reading."""
    yield from (f"## `{reading.id}`", "", paragraph(reading.question), "")
    for name, meaning in reading.alternatives.items():
        default = " (default)" if name == reading.default and not reading.is_note else ""
        yield item(f"**`{name}`**{default}: {meaning}")
    deviating = {p: reading.under(p) for p in PROFILES if reading.under(p) != reading.default}
    if deviating:
        yield from ("", paragraph("Other profiles: " + ", ".join(f"`{p}`: `{a}`" for p, a in deviating.items()) + "."))
    if reading.consequence:
        yield from ("", paragraph(reading.consequence))
    if reading.places:
        yield from ("", paragraph("In the paper: " + "; ".join(reading.places) + "."))
    if reading.probe is not None:
        yield from ("", "```scenic", reading.probe.program.strip(), "```", "")
        yield from (item(f"`{name}`: {shown}") for name, shown in reading.probe.shows.items())


def allowed_page() -> str:
    """The table of what programs without `--trust` may ask of values."""
    about = (
        "A program without `--trust` meets values of these types, and may ask each for these attributes and methods. A type also has those of the "
        "types from which it is derived. See [running programs of others](../security.md)."
    )
    lines = ["# What a program may ask for", "", paragraph(about), "", "| type | attributes and methods |", "| --- | --- |"]
    lines += [
        f"| `{type_.__name__}` | {' '.join(f'`{name}`' for name in sorted(known)) or '-'} |" for type_, known in sandbox_table.ATTRIBUTES.items()
    ]
    for title, known in (
        ("Builtins of Python", sandbox_table.BUILTINS), ("Names that a class may define", sandbox_table.OVERRIDES),
        ("Classes that a class may be derived from", {base.__name__ for base in sandbox_table.BASES}),
    ):
        lines += ["", f"## {title}", "", paragraph(" ".join(f"`{name}`" for name in sorted(known)))]
    lines += ["", "## What methods of a program can do to Python's own types", "", paragraph(
        "Python calls methods of a program's classes while it compares, hashes, orders or writes what a container holds. Why it survives that:"
    ), "", "| type | why |", "| --- | --- |"]  # fmt: skip
    lines += [f"| `{type_.__name__}` | {why} |" for type_, why in sandbox_table.SAFE.items()]
    called: dict[str, list[str]] = {}
    for function, why in sandbox_table.SAFE_FUNCTIONS.items():
        if not isinstance(function, type):
            called.setdefault(why, []).append(f"`{function.__name__}`")
    lines += ["", "| function | why |", "| --- | --- |", *(f"| {' '.join(sorted(those))} | {why} |" for why, those in called.items())]
    return "\n".join(lines) + "\n"


STATUS = {"read": "read", "reading": "read, by the reading", "refused": "refused"}


def productions_page() -> str:
    """Every production of the released grammars, as the file of the tests says."""
    table = tomllib.loads((HERE.parents[1] / "tests/released/productions.toml").read_text(encoding="utf-8"))["production"]
    counts = Counter((dialect, entry["status"]) for entry in table for dialect in entry["dialects"])
    told = [
        f"of `{d}` {counts[d, 'read']} are read, {counts[d, 'reading']} by a reading, {counts[d, 'refused']} refused"
        for d in ("scenic-2.1", "scenic-3")
    ]
    about = (
        "The grammars of the released implementations, 2.1.0 and 3.1.1 (in two dimensions), production by production, and what the dialects "
        f"`scenic-2.1` and `scenic-3` make of them: {'; '.join(told)}. Without an `x` the release lacks the production; the dialect may read "
        "it all the same. A test runs a program for each line. What a program means is said in "
        "[the language](../language.md)."
    )
    lines = ["# What the released grammars have", "", paragraph(about)]
    part = ""
    for entry in table:
        if entry["part"] != part:
            part = entry["part"]
            lines += ["", f"## {part}", "", "| production | `scenic-2.1` | `scenic-3` | |", "| --- | --- | --- | --- |"]
        marks = ["x" if d in entry["dialects"] else "" for d in ("scenic-2.1", "scenic-3")]
        links = ", ".join(f"[`{name}`](readings.md#{name})" for name in entry.get("readings", ()))
        what = f"{STATUS[entry['status']]} {links}".strip() + (f": {cell(entry['why'])}" if "why" in entry else "")
        lines.append(f"| {cell(entry['form'])} | {' | '.join(marks)} | {what} |")
    return "\n".join(lines) + "\n"


def maps_page() -> str:
    """Every kind of map that is made, with its parameters."""
    lines = ["# Maps that are made", "", "What `scenic-ref map --make KIND -p NAME=VALUE FILE.xodr` makes ([Roads](../roads.md#maps))."]
    for name, kind in KINDS.items():
        rows = (f"| `{one}` | {found.default} | {found.values} | {found.about} |" for one, found in kind.parameters.items())
        lines += ["", f"## {name}", "", paragraph(f"It has {kind.description}."), "", VALUES, *rows]
    return "\n".join(lines) + "\n"


def differences_page() -> str:
    """Return the page of differences: a table by chapter, then each cause with its passage and vectors."""
    kept, known, vectors = results.shipped_results(), shipped_differences(), load_vectors()
    names = list(kept)
    counts: dict[str, dict[str, Counter[str]]] = {}
    for vector in vectors:
        for name in names:
            line = kept[name].get(vector.name, "skipped")
            counts.setdefault(vector.chapter, {}).setdefault(name, Counter())[results.status_in(line)] += 1
    about = (
        "Every [vector](../vectors.md) was put to the released implementations, each in its own environment and dialect, by "
        "`scenic-ref conformance --impl scenic==VERSION` ([how](../harness.md)). A cell says how many passed, and how many failed; the others were "
        "skipped, since the program cannot be said in that dialect or needs a reading that the release does not follow. scenic-ref passes all. "
        "Differences are grouped by their cause, and each one was read beside the paper: does what the release answered follow from that cause, and "
        "is the passage about it? Below each program are the answers of the releases; what one *is not*, or is *instead of*, is the answer here."
    )
    heads, rule = " | ".join(names), " --- |" * len(names)
    lines = ["# Differences", "", paragraph(about), "", f"| chapter of the paper | vectors | {heads} |", f"| --- | --- |{rule}"]
    for chapter, by in counts.items():
        total = sum(by[names[0]].values())
        lines.append(f"| {cell(chapter)} | {total} | {' | '.join(outcome(by[name]) for name in names)} |")
    whole = {name: sum((by[name] for by in counts.values()), Counter[str]()) for name in names}
    lines.append(f"| *all* | {len(vectors)} | {' | '.join(outcome(whole[name]) for name in names)} |")
    lines += ["", "## By class", "", f"| class | means | {heads} |", f"| --- | --- |{rule}"]
    for class_, means in CLASSES.items():
        numbers = [sum(len(d.vectors) for d in known if d.class_ == class_ and name in d.implementations) for name in names]
        if any(numbers):
            lines.append(f"| {class_} | {cell(means)} | {' | '.join(map(str, numbers))} |")
    lines += ["", "## By cause", ""]
    texts = {vector.name: vector for vector in vectors}
    found = causes(known)
    for class_ in CLASSES:
        lines += [f"### {class_.capitalize()}", ""] if any(cause.class_ == class_ for cause in found) else []
        for cause in found:
            if cause.class_ == class_:
                lines += cause_lines(cause, texts, kept)
    return "\n".join(lines).rstrip() + "\n"


def cause_lines(cause: KnownCause, vectors: Mapping[str, ConformanceVector], kept: Mapping[str, Mapping[str, str]]) -> list[str]:
    """A cause: why, the passage, the smallest program that shows it, what each release says of it, and a picture where places differ."""
    names = cause.smallest_first(vectors)
    pictured = pictured_scenes()
    mine = {OURS, *cause.implementations}
    example = next((name for name in names if name in pictured and pictured[name].keys() <= mine), names[0])
    more = f", and {len(names) - 1} more: `scenic-ref conformance --impl scenic==VERSION -v` lists them" if len(names) > 1 else ""
    agree = "".join(f" They agree under `{reading}`: {alternatives_in_words(reading)}." for reading in cause.readings)
    lines = [paragraph(f"**{cause.why}** *{', '.join(cause.implementations)}.* {'; '.join(cause.passages)}.{agree}"), ""]
    program = next(iter(vectors[example].texts.values())).strip().splitlines()
    if len(program) <= LONGEST_EXAMPLE:
        lines += ["```scenic", *program, "```", ""]
    lines += [item(f"{name}: {cell(kept[name].get(example, 'skipped'))}") for name in kept]
    lines += ["", paragraph(f"Vector `{example}`{more}."), ""]
    return lines + ([f"![scenes here and there](differences/{example}.png)", ""] if pictured.get(example, {}).keys() & mine - {OURS} else [])


def alternatives_in_words(readings: str) -> str:
    """Return the meanings of the alternatives in a text such as "soft = scene, angle = heading"."""
    named = (part.partition(" = ") for part in readings.split(", "))
    return "; ".join(READINGS[id].alternatives[alternative].rstrip(".") for id, _, alternative in named)


def campaigns_page() -> str:
    """Return the findings of campaigns against the releases: the program, both answers, the passage, who is right."""
    about = (
        "Programs were invented, compared with each release, and made small, by `scenic-ref fuzz --impl scenic==VERSION` "
        "([how](../harness.md)): both sides followed the readings that the release was known to follow then, so that most of what is listed is "
        "something else. Each finding was confirmed with fresh scenes of the smallest program, then given its class by hand; one cause may have "
        "several findings, which have the same reason. Most of what is `missing` or `unchecked` is documented by the releases. Figures in per cent "
        "are shares of the scenes that were drawn here and there. Where places differ, a picture shows thirty scenes of each side over each other, "
        "ego in orange. Where nothing else is said a campaign took an hour or two of one process on a busy machine. The findings of the class "
        "`our bug` are no differences, but faults of this reference or of its judge that the campaign brought to light; they are mended."
    )
    lines = ["# Campaigns", "", paragraph(about), ""]
    for campaign in shipped_findings():
        counts = Counter(found.class_ for found in campaign.findings)
        told = ", ".join(f"{counts[class_]} {class_}" for class_ in CLASSES_OF_FINDINGS if counts[class_])
        short = {found.why for found in campaign.findings if found.class_ in DEVIATIONS and len(found.program.strip().splitlines()) <= FEW_LINES}
        reasons = f"{len({found.why for found in campaign.findings})} reasons, {len(short)} of them"
        kinds = f"`bug`, `missing` or `unchecked` with a program of at most {FEW_LINES} lines"
        lines += [f"## {campaign.name}", "", paragraph(f"{campaign.about} {len(campaign.findings)} findings, {told}, for {reasons} {kinds}."), ""]
        for number, found in enumerate(campaign.findings, 1):
            lines += finding_lines(campaign.name, number, found)
    return "\n".join(lines).rstrip() + "\n"


def finding_lines(name: str, number: int, found: JudgedFinding) -> list[str]:
    """A finding of a campaign."""
    head = ": ".join(part for part in (found.topic, found.class_) if part)
    lines = [f"### {name}, {number}: {head}", "", "```scenic", *found.program.strip().splitlines(), "```", ""]
    lines += [paragraph(found.why), ""] if found.why else []
    agrees = f" They agree under `{found.reading}`." if found.reading else ""
    told = f"{found.kind.capitalize()}: {cell(found.detail)}.{agrees} *{cell(found.passage)}.* Programs that show it: {found.programs}."
    lines += [paragraph(told), ""]
    if found.here or found.there:
        lines += [f"![scenes here and there](campaigns/{picture_name(name, number)})", ""]
    return lines


def listings_page() -> str:
    """The dynamic listings of the paper, each with what was added to it that it runs."""
    about = (
        "Every listing of the Sections \"Dynamic Scenarios\" and \"Compositional Scenarios\" runs as it is printed, on the road networks of the "
        "driving library. In each program, lines without a mark are the paper's, those with + were added, and a line with - is one of the "
        "paper's with `...`, followed by what is in its place. That the programs differ from the paper in nothing else is tested, and so is what "
        "happens in each, in the simulators `kinematic` and `pymunk`. Pictures show time steps of one simulation, in `kinematic`: ego in orange, the "
        "way that each object has come as a line, traffic lights as dots."
    )
    listings, programs = read_manifest(LISTINGS)
    lines = ["# The paper's dynamic listings", "", paragraph(about), ""]
    for program in programs:
        sections = dict.fromkeys(listings[name].section for name in program.listings)
        names = [f'"{section}"' for section in sections]
        lines += [f"## `{program.file}`", "", paragraph(f"Section {', '.join(names)}. {program.around}"), "", "```diff"]
        for line in complete_listings((LISTINGS / program.file).read_text(encoding="utf-8"), [listings[name] for name in program.listings]):
            lines += [f"- {line.printed}"] if line.printed else []
            lines.append(f"{'  ' if line.origin is LineOrigin.PRINTED else '+ '}{line.text}".rstrip())
        readings = "".join(f" --reading {name}={value}" for name, value in program.readings.items())
        command = f"scenic-ref simulate examples/paper/dynamic/{program.file} --simulator kinematic --steps {program.steps}{readings} --gif run.gif"
        lines += ["```", "", paragraph(f"What happens: {program.fires}"), "", "```console", f"$ {command}", "```", ""]
        lines += [f"![time steps of a simulation](listings/{Path(program.file).stem}.png)", ""] if program.shown else []
    return "\n".join(lines).rstrip() + "\n"


def sheet(program: CompletedProgram) -> bytes:
    """The picture of a program on that page."""
    scenario = scenic_ref.load(LISTINGS / program.file, readings=program.readings)
    simulation = scenario.simulate("kinematic", program.steps, program.seed).simulation
    last = simulation.moments[-1].step
    return contact_sheet(simulation, [min(step, last) for step in program.shown])


def picture_name(name: str, number: int) -> str:
    """The file of a finding's picture."""
    return f"{name.replace(',', '').replace(' ', '-')}-{number}.png"


def pictures() -> Iterator[tuple[str, Callable[[], bytes]]]:
    """The pictures of the pages: their places, and what draws them."""
    yield "roads/suburb.svg", lambda: map_picture(made_map("suburb", signals=True, crosswalks=True), format="svg")
    for program in read_manifest(LISTINGS)[1]:
        if program.shown:
            yield f"listings/{Path(program.file).stem}.png", partial(sheet, program)
    for campaign in shipped_findings():
        for number, found in enumerate(campaign.findings, 1):
            if found.here or found.there:
                yield f"campaigns/{picture_name(campaign.name, number)}", partial(side_by_side, {OURS: found.here, campaign.name: found.there})
    for vector, sides in pictured_scenes().items():
        yield f"differences/{vector}.png", partial(side_by_side, sides)


def outcome(counts: Counter[str]) -> str:
    """How many passed and failed, of those that were not skipped."""
    wrong = counts["failed"] + counts["errored"]
    return f"{counts['passed']} passed, {wrong} failed" if counts["passed"] or wrong else "skipped"


PAGES = {
    "rules.md": rules_page, "proofs.md": proofs_page, "readings.md": readings_page, "commands.md": commands_page, "allowed.md": allowed_page,
    "listings.md": listings_page, "productions.md": productions_page, "differences.md": differences_page, "campaigns.md": campaigns_page,
    "maps.md": maps_page, "constructors.md": constructors_page,
}  # fmt: skip


def main() -> None:
    """Write all generated pages below `docs`."""
    HERE.mkdir(exist_ok=True)
    (HERE / "commands").mkdir(exist_ok=True)
    for name, text in {**{name: page() for name, page in PAGES.items()}, **command_pages()}.items():
        (HERE / name).write_text(text, encoding="utf-8")
    for name, drawn in pictures():
        (HERE / name).parent.mkdir(exist_ok=True)
        (HERE / name).write_bytes(drawn())


if __name__ == "__main__":
    main()
