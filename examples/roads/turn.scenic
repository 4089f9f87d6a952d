# A car that will take a maneuver that is drawn, near the intersection, and another one where it will come out.
model scenic.domains.driving.model
param map = localPath('town.xodr')
crossing = Uniform(*network.intersections)
turn = Uniform(*crossing.maneuvers)
ego = Car on turn.startLane.centerline
Car on turn.endLane.centerline, with requireVisible False
require (distance from ego to crossing) < 20
