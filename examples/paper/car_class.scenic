# The paper, Section "Basic Scenarios": how the definition of Car begins ("slightly simplified"), as printed,
# completed by the world's regions, a size, and two cars.
from scenic.simulators.gta.model import road, roadDirection

class Car:
    position: Point on road
    heading: roadDirection at self.position

    width: 2
    length: 4.5

ego = Car
Car visible
