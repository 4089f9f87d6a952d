"""Which known name somebody meant: the one place that knows how near is near enough to be suggested."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import islice
from typing import cast

MOST_SLIPS, SWAPPED = 3, 2
LONG = 5
"""Of shorter names that no model of the program has, none but one in other letters is taken for one of a world model."""
LONGEST = 100
"""Of longer names no slips are looked for: the work grows with the square of the letters, and programs are hostile."""
MOST_COMPARED, MOST_TOLD = 1000, 8
"""Keys of a dictionary that are compared with one that it does not have, and that are named."""
SHORTEST_BEGINNING = 3
"""A name that is cut short after so many letters, and not before its middle, is known by its beginning."""
SHORTEST_WITH_ENDING, LONGEST_ENDING = 4, 2
"""A name of so many letters may be meant with so many more behind it: `leader` for `lead`."""

CONSTANTS = ("True", "False", "None")
OF_OTHERS: Mapping[str, str] = {
    "null": "write None", "nil": "write None", "undefined": "write None", "this": "write self", "pi": "write math.pi, after `import math`",
    "self": "it is the object itself in classes, specifiers and behaviors; elsewhere name the object, as in ego.width",
    "random": "draw with Range, Uniform or Normal", "np": "draw with Range, Uniform or Normal; math has functions of numbers",
    "sqrt": "write math.sqrt, after `import math`", "randint": "write DiscreteRange(low, high)", "choice": "write Uniform(a, b, ...)",
    "radians": "write `30 deg` for the angle of 30 degrees; angles are in radians",
    "degrees": "write math.degrees(x), after `import math`",
    "uniform": "write Range(low, high)", "gauss": "write Normal(mean, stdDev)", "sin": "write math.sin, after `import math`",
    "cos": "write math.cos, after `import math`", "time": "a simulation has simulation().currentTime, in time steps",
    "always": "write `require always B` as a statement of its own, and for `not always B` write `require eventually not (B)`",
    "eventually": "write `require eventually B` as a statement of its own, and for `not eventually B` write `require always not (B)`",
    "distance": "it is an operator: write `distance from A to B`", "angle": "it is an operator: write `angle from A to B`",
    "math": "it is a module: begin with `import math`",
    "that": "behind `require` the condition follows at once, without `that`",
}
"""Names that people bring from Python and other languages, and what to write for them."""
OF_OBJECTS = ("position", "heading", "width", "length", "speed", "velocity", "viewAngle", "viewDistance")


def undefined_name_hint(name: str, known: Iterable[str], elsewhere: Mapping[str, tuple[str, ...]]) -> str:
    """The hint about a name that is not defined, where these are `known` and others are in world models."""
    near = nearest(name, [*known, *CONSTANTS])
    found = name if name in elsewhere else None
    if near is None and found is None:
        found = next((n for n in (nearest(name, elsewhere),) if n is not None and (len(name) >= LONG or n.casefold() == name.casefold())), None)
    if found is not None:
        models = " and ".join(elsewhere[found])
        where = f"the world model{'s' if len(elsewhere[found]) > 1 else ''} {models}: begin with `model {elsewhere[found][0]}`"
        return f"it is in {where}" if found == name else f"did you mean {found}, of {where}?"
    if name in OF_OTHERS:
        return OF_OTHERS[name]
    if near is not None:
        return f"did you mean {near}?"
    if name in OF_OBJECTS:
        return f"it is a property: write ego.{name}, or self.{name} in a class"
    if name[:1].isupper():
        return "import it, or choose a world model with `model NAME`"
    return "assign it first, or import it; a text stands in quotation marks"


def nearest(name: str, known: Iterable[str]) -> str | None:
    """The known name that `name` is most likely a slip of: the one with the fewest slips, None where all have too many."""
    found = [(slips, one) for one in known if one != name and (slips := slips_between(name.casefold(), one.casefold())) is not None]
    return min(found, key=lambda pair: (pair[0], pair[1][:1] != name[:1], pair[1][:1].casefold() != name[:1].casefold()))[1] if found else None


def did_you_mean(name: str, known: Iterable[str], otherwise: str = "") -> str:
    """The hint that names the nearest known name, `otherwise` where none is near."""
    near = nearest(name, known)
    return f"did you mean {near}?" if near is not None else otherwise


def meant_parameter(name: str, parameters: Sequence[str]) -> str:
    """The hint about an argument that does not fit: the nearest parameter, if it has a name, and all parameters."""
    if not parameters:
        return "it has no parameters"
    holding = [one for one in parameters if len(name) >= SHORTEST_BEGINNING and name.casefold() in one.casefold()]
    near = None if not name else nearest(name, parameters) or (holding[0] if len(holding) == 1 else None)
    verb = "parameters are" if len(parameters) > 1 else "parameter is"
    more = ", ..." if len(parameters) > MOST_TOLD else ""
    every = f"its {verb} {', '.join(parameters[:MOST_TOLD])}{more}"
    return every if near is None else f"did you mean {near}? I{every[1:]}"


def note_keys(error: BaseException, container: object, key: object) -> None:
    """Note what may be meant by a text that is no key of a dictionary: a similar one, or one of the first."""
    if type(error) is not KeyError or type(container) is not dict or type(key) is not str:
        return
    names = cast("dict[object, object]", container)
    texts = [known for known in islice(names, MOST_COMPARED) if type(known) is str]
    more = ", ..." if len(names) > MOST_TOLD else ""
    otherwise = "none of its keys is a text" if names else "the dictionary is empty"
    error.add_note(did_you_mean(key, texts, f"there are {', '.join(texts[:MOST_TOLD])}{more}" if texts else otherwise))


def slips_between(name: str, known: str) -> int | None:
    """How many slips make a known name this one, None for too many: more than one for every four letters, but where letters are only swapped."""
    if SHORTEST_BEGINNING <= len(name) < len(known) <= 2 * len(name) and known.startswith(name):
        return len(known) - len(name)
    if len(known) >= SHORTEST_WITH_ENDING and 0 < len(name) - len(known) <= LONGEST_ENDING and name.startswith(known):
        return len(name) - len(known)
    most = min(max(len(name), len(known)) // 4, MOST_SLIPS)
    if abs(len(known) - len(name)) > most or len(name) > LONGEST:
        return None
    slips = edit_distance(name, known)
    return slips if slips <= most or (slips <= SWAPPED and sorted(name) == sorted(known)) else None


def edit_distance(one: str, other: str) -> int:
    """The fewest letters to add, leave out, replace, or swap with the next, that make one text the other."""
    before: list[int] = []
    row = list(range(len(other) + 1))
    for i, a in enumerate(one, 1):
        earlier, before, row = before, row, [i]
        for j, b in enumerate(other, 1):
            best = min(before[j] + 1, row[j - 1] + 1, before[j - 1] + (a != b))
            if i > 1 and j > 1 and a == other[j - 2] and one[i - 2] == b:
                best = min(best, earlier[j - 2] + 1)
            row.append(best)
    return row[-1]
