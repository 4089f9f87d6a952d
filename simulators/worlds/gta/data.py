"""Constants of the GTA-like world: 13 car models, car colors with weights, 14 types of weather with weights."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, NamedTuple


@dataclass(frozen=True, slots=True)
class CarModel:
    """A car model: its name and its bounding box, in metres (`height` is the appendix's word for `length`)."""

    name: str
    width: float
    length: float

    scenic_names: ClassVar[frozenset[str]] = frozenset({"name", "width", "length", "height"})

    @property
    def height(self) -> float:
        """The extent along the y axis (reading `height`)."""
        return self.length

    def __repr__(self) -> str:
        return f"CarModel({self.name})"


MODELS = {
    m.name: m
    for m in (
        CarModel("ASEA", 1.83, 4.46),
        CarModel("BALLER", 2.11, 5.10),
        CarModel("BISON", 2.29, 5.48),
        CarModel("BLISTA", 1.76, 4.10),
        CarModel("BOBCATXL", 2.38, 5.78),
        CarModel("BUFFALO", 2.04, 5.08),
        CarModel("BUS", 2.90, 13.20),
        CarModel("DOMINATOR", 1.94, 4.94),
        CarModel("GRANGER", 3.03, 5.95),
        CarModel("JACKAL", 2.00, 4.94),
        CarModel("NINEF", 2.08, 4.51),
        CarModel("ORACLE", 2.08, 5.13),
        CarModel("PATRIOT", 2.27, 5.11),
    )
}


class RGB(NamedTuple):
    """A color: red, green and blue, reals in [0, 1]."""

    r: float
    g: float
    b: float


RGB.scenic_names = frozenset({"r", "g", "b"})  # type: ignore[attr-defined]  # a named tuple takes it for a field


def byte_to_real(color: tuple[float, ...] | list[float]) -> tuple[float, ...]:
    """A color given by bytes, as reals in [0, 1]."""
    return tuple(part / 255 for part in color)


COLOR_WEIGHTS = {
    byte_to_real(color): weight
    for color, weight in (
        ((246, 246, 244), 24),  # white
        ((28, 28, 30), 19),  # black
        ((190, 192, 194), 16),  # silver
        ((118, 120, 122), 15),  # gray
        ((168, 44, 40), 10),  # red
        ((44, 82, 142), 7),  # blue
        ((136, 112, 88), 5),  # brown
        ((208, 176, 72), 2),  # yellow
        ((52, 104, 76), 2),  # green
    )
}

WEATHER_WEIGHTS = {
    "NEUTRAL": 5, "CLEAR": 15, "EXTRASUNNY": 20, "CLOUDS": 15, "OVERCAST": 15, "RAIN": 5, "THUNDER": 5, "CLEARING": 10,
    "SMOG": 5, "FOGGY": 5, "XMAS": 1, "SNOWLIGHT": 1, "BLIZZARD": 1, "SNOW": 1,
}
