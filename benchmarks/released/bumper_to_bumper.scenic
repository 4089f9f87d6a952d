from gta import *
depth = 4
laneGap = 3.5
carGap = Range(1, 3)
laneShift = Range(-2, 2)
wiggle = Range(-5 deg, 5 deg)
modelDist = Uniform(*MODELS.values())
def createLaneAt(car):
    createPlatoonAt(car, depth, dist=carGap, wiggle=wiggle, model=modelDist)
ego = new Car with visibleDistance 60
leftCar = carAheadOfCar(ego, laneShift + carGap, offsetX=-laneGap, wiggle=wiggle)
createLaneAt(leftCar)
midCar = carAheadOfCar(ego, resample(carGap), wiggle=wiggle)
createLaneAt(midCar)
rightCar = carAheadOfCar(ego, resample(laneShift) + resample(carGap), offsetX=laneGap, wiggle=wiggle)
createLaneAt(rightCar)
