"""Termination, Step 1: Apply Mutations (Figure "Semantics of statements"). `termination` asks for the noise, and comes back with it."""

from __future__ import annotations

from typing import NamedTuple

from ..machine.config import State
from ..machine.draws import invalid
from ..machine.operand_kinds import Reader, is_scalar
from ..machine.outcome import Stuck
from ..machine.values import Instance
from ..space.distributions import BadParameters, Normal
from ..space.numeric_functions import larger, smaller, to_floats
from ..space.vectors import Vector
from ..store.errors import RunError

POSE = 3  # x, y and heading
NOISY_PROPERTIES = ("position", "heading", "color")
COLOR_DEVIATION = 0.05  # where an object has no property colorStdDev, as in the world model of the released implementations


class Noise(NamedTuple):
    """A premise of the rule, in `state`: the next n_i of object number `i` comes from `normal`; `drawn` are those before it."""

    i: int
    drawn: tuple[object, ...]
    normal: Normal
    state: State


def apply_mutations(index: int, drawn: tuple[object, ...], state: State) -> Noise | Stuck | State:
    """If for every o_i in O = {o_1, ..., o_n}
        S_i = O(o_i.mutationScale), ps_i = O(o_i.positionStdDev), hs_i = O(o_i.headingStdDev),
        ⟨Normal(0, S_i · ps_i)⟩ →^{r_{i,x}} n_{i,x}, ⟨Normal(0, S_i · ps_i)⟩ →^{r_{i,y}} n_{i,y}, ⟨Normal(0, S_i · hs_i)⟩ →^{r_{i,h}} n_{i,h},
        pos_i = O(o_i.position) + (n_{i,x}, n_{i,y}) and head_i = O(o_i.heading) + n_{i,h},
    then ⟨pass, σ, π, O⟩ →^{r_{0,x} r_{0,y} r_{0,h} ...} ⟨Done, σ, π, O[o_i.position / pos_i][o_i.heading / head_i]⟩.

    The premises about objects before number `index`, and about that one as far as its noise is `drawn`, are known. Gives the next one, or the
    state in which all hold. A standard deviation of 0 is a point mass: no draw, probability 1 (reading `zero-stddev`).
    """
    for i in range(index, len(state.scene)):
        o, noise = state.scene[i], drawn if i == index else ()
        if not Reader(state).property(o, "mutationScale"):
            continue
        while len(noise) < POSE + len(color_of(o, state)):
            try:
                normal = normal_of(o, len(noise), state)
            except BadParameters as bad:
                return invalid("T-Mutate", bad, o.span, state)
            if normal.stdDev == 0:
                noise = (*noise, 0.0)
            else:
                return Noise(i, noise, normal, state)
        state = mutate_object(o, noise, state)
    return state


def normal_of(o: Instance, component: int, state: State) -> Normal:
    """Normal(0, S_i · ps_i) for x and y, Normal(0, S_i · hs_i) for the heading; then one for each component of the color."""
    reader = Reader(state)
    scale = reader.property(o, "mutationScale")
    if component < POSE:
        deviation = reader.property(o, "headingStdDev" if component == 2 else "positionStdDev")
    else:
        deviation = reader.plain(state.objects[o.number].get("colorStdDev", COLOR_DEVIATION))
    try:
        return Normal(0.0, to_floats(scale) * to_floats(deviation))
    except TypeError:
        raise RunError(f"the standard deviation of the noise on {o!r} is not a number", o.span, rule="T-Mutate") from None


def color_of(o: Instance, state: State) -> tuple[float, ...]:
    """The components of the color to which noise is added: none under `mutate-color=no`, or if the color is no tuple of reals."""
    if state.reading("mutate-color") == "no":
        return ()
    color = Reader(state).plain(state.objects[o.number].get("color"))
    return color if isinstance(color, tuple) and all(is_scalar(c) for c in color) else ()


def mutate_object(o: Instance, noise: tuple[object, ...], state: State) -> State:
    """O[o_i.position / pos_i][o_i.heading / head_i], where pos_i = O(o_i.position) + (n_{i,x}, n_{i,y}) and head_i = O(o_i.heading) + n_{i,h}.

    Under `mutate-color=yes` the color gets noise as well, and its components are kept within [0, 1].
    """
    reader = Reader(state)
    dx, dy, turn, *tints = (reader.plain(n) for n in noise)
    position = reader.property(o, "position")
    heading = reader.property(o, "heading")
    moved = {"position": reader.wrap(Vector(position.x + dx, position.y + dy)), "heading": reader.wrap(heading + turn)}  # type: ignore[operator]
    if tints:
        tinted = zip(color_of(o, state), tints, strict=True)
        moved["color"] = reader.wrap(tuple(smaller(1.0, larger(0.0, c + t)) for c, t in tinted))  # type: ignore[operator]
    return state.with_properties(o, moved)
