# The world of the gallery for Scenic 3: the regions, field and classes of this project's city, which `world.json` holds.

import collections
import json
import pathlib
import shapely.geometry
from scenic.core.vectors import PolygonalVectorField
from scenic.core.regions import PolygonalRegion, PolylineRegion

param world = None
data = json.loads(pathlib.Path(globalParameters.world).read_text())
cells = [(shapely.geometry.Polygon(ring), heading) for ring, heading in data["cells"]]
roadDirection = PolygonalVectorField("roadDirection", cells)
road = PolygonalRegion(polygon=shapely.geometry.shape(data["road"]), orientation=roadDirection)
curb = PolylineRegion(polyline=shapely.geometry.MultiLineString(data["curbs"]), orientation=roadDirection)
workspace = Workspace(road)

Model = collections.namedtuple("Model", "name width length")
MODELS = {name: Model(name, width, length) for name, width, length in data["models"]}
COLORS = {tuple(color): weight for color, weight in data["colors"]}

param time = Range(0, 24 * 60)
param weather = Discrete(data["weather"])

class Car:
    position: new Point on road
    heading: (roadDirection at self.position) + self.roadDeviation
    roadDeviation: 0
    width: self.model.width
    length: self.model.length
    viewAngle: 80 deg
    visibleDistance: 30
    model: Uniform(*MODELS.values())
    color: Discrete(COLORS)

class EgoCar(Car):
    model: MODELS["BLISTA"]

def createPlatoonAt(car, numCars, model=None, dist=Range(2, 8), shift=Range(-0.5, 0.5), wiggle=0):
    cars = [car]
    lastCar = car
    for i in range(numCars - 1):
        center = follow roadDirection from (front of lastCar) for resample(dist)
        pos = new OrientedPoint right of center by shift, facing resample(wiggle) relative to roadDirection
        lastCar = new Car ahead of pos, with model (car.model if model is None else resample(model))
        cars.append(lastCar)
    return cars

def carAheadOfCar(car, gap, offsetX=0, wiggle=0):
    pos = new OrientedPoint at (front of car) offset by (offsetX, gap), facing resample(wiggle) relative to roadDirection
    return new Car ahead of pos
