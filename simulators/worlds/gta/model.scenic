# The world model for a GTA-like city (the paper, Appendix "Gallery of Scenarios", first section).
# Regions and the traffic direction come from the synthetic city; everything else is defined here.

from scenic.simulators.gta.map import road, curb, roadDirection, MODELS, COLOR_WEIGHTS, WEATHER_WEIGHTS

workspace = Workspace(road)

# The 13 models: a name, a width and a length in metres.
class CarModel(object):
    models = MODELS

    def defaultModel():
        return Uniform(*MODELS.values())

BUS = MODELS['BUS']

# Colors are triples of reals in [0, 1].
class CarColor(object):
    def defaultColor():
        return Discrete(COLOR_WEIGHTS)

    def byteToReal(color):
        return tuple([part / 255 for part in color])

class Car:
    position: Point on road
    heading: (roadDirection at self.position) \
             + self.roadDeviation
    roadDeviation: 0
    width: self.model.width
    length: self.model.length  # `height` in the paper, which is another property in the profiles of the releases (reading `height`)
    viewAngle: 80 deg
    visibleDistance: 30
    model: CarModel.defaultModel()
    color: CarColor.defaultColor()

class EgoCar(Car):
    model: CarModel.models['BLISTA']

class Bus(Car):
    model: BUS

class Compact(Car):
    model: CarModel.models['BLISTA']

# Global parameters: minutes since midnight, and one of 14 types of weather; rain is less likely than shine.
param time = Range(0, 24 * 60), \
      weather = Discrete(WEATHER_WEIGHTS)

# Figure "Helper function for creating a platoon starting from a given car"; the cars are returned, the given one first.
def createPlatoonAt(car, numCars, model=None, dist=Range(2, 8), shift=Range(-0.5, 0.5), wiggle=0):
    cars = [car]
    lastCar = car
    for i in range(numCars-1):
        center = follow roadDirection from (front of lastCar) for resample(dist)
        pos = OrientedPoint right of center by shift,
                facing resample(wiggle) relative to roadDirection
        lastCar = Car ahead of pos, with model (car.model if model is None else resample(model))
        cars.append(lastCar)
    return cars

# Figure "Helper function for placing a car ahead of a car, with a specified gap in between"
def carAheadOfCar(car, gap, offsetX=0, wiggle=0):
    pos = OrientedPoint at (front of car) offset by (offsetX, gap),
            facing resample(wiggle) relative to roadDirection
    return Car ahead of pos
