# The paper, Section "Basic Scenarios", "Classes, Objects, Geometry, and Distributions": its first program, as printed.
from scenic.simulators.gta.model import *
ego = Car
Car
