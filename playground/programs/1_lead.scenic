# Two cars on a street
# Change a number: the scenes are drawn anew.
lane = RectangularRegion((0, 30), 0, 8, 90)
workspace = Workspace(lane)

class Car:
    width: 2
    length: 4.5
    color: Uniform('red', 'white', 'black')

ego = Car at (Range(-2, 2), 4), facing Range(-5, 5) deg
lead = Car ahead of ego by Range(3, 25),
    facing Range(-15, 15) deg

require (distance to lead) > 12
require[0.8] lead.position.x > 0
param gap = distance to lead
