# Traffic lights while a simulation runs: each follows the plan of its intersection (docs/roads.md), unless the program sets or freezes it.
# What a program did to lights is kept here, in variables of its own run.

from scenic.domains.driving.arguments import check_arguments
from scenic.domains.driving.paths import Trajectory

clock = {'late': 0, 'frozen': None}  # how many seconds the lights have stood still so far; the time of the plan at which they do now
given = {}  # of lights that were set: how often the plan had changed them until then, and their state

# The time in the plan of the lights, in seconds; scenes are at its beginning.
def timeOfLights():
    if in initial scenario:
        return 0
    return simulation().currentRealTime - clock['late'] if clock['frozen'] is None else clock['frozen']

# Whether a light is green, yellow or red: as it was set, until the plan changes it next; `off` if it is no light of an intersection.
def getTrafficLightStatus(signal):
    check_arguments('getTrafficLightStatus', signal)
    time = timeOfLights()
    if signal in given and given[signal][0] == signal.changesUntil(time):
        return given[signal][1]
    return signal.stateAt(time)

# Whether a light is red, and will be as long as that.
def staysRed(signal, seconds):
    later = [signal.stateAt(timeOfLights() + k * seconds / 20) for k in range(21)]
    return getTrafficLightStatus(signal) == 'red' and all([state == 'red' for state in later])

def setTrafficLightStatus(signal, color):
    check_arguments('setTrafficLightStatus', signal, color)
    given[signal] = (signal.changesUntil(timeOfLights()), color)

def setAllIntersectionTrafficLightsStatus(intersection, color):
    check_arguments('setAllIntersectionTrafficLightsStatus', intersection, color)
    for signal in intersection.signals:
        if signal.isTrafficLight:
            setTrafficLightStatus(signal, color)

# From now on no light changes but by `setTrafficLightStatus` and the like; and then they go on.
def freezeTrafficLights():
    if clock['frozen'] is None:
        clock['frozen'] = timeOfLights()

def unfreezeTrafficLights():
    if clock['frozen'] is not None:
        clock['late'] = simulation().currentRealTime - clock['frozen']
        clock['frozen'] = None

# The light at the end of a vehicle's lane, if it is at most so far ahead, along the lane from the vehicle's middle to where one waits; else None.
def closestTrafficLight(vehicle, distance=100):
    lane = vehicle._lane
    signal = None if lane is None else lane._trafficLight
    if signal is None:
        return None
    return signal if signal.stopLine(lane) - Trajectory([lane]).along(vehicle.position) <= distance else None

def getClosestTrafficLightStatus(vehicle, distance=100):
    check_arguments('getClosestTrafficLightStatus', vehicle, distance)
    signal = closestTrafficLight(vehicle, distance)
    return None if signal is None else getTrafficLightStatus(signal)

# The light ahead, if there is one: a program may run where there are none.
def setClosestTrafficLightStatus(vehicle, color, distance=100):
    check_arguments('setClosestTrafficLightStatus', vehicle, color, distance)
    signal = closestTrafficLight(vehicle, distance)
    if signal is not None:
        setTrafficLightStatus(signal, color)

def withinDistanceToTrafficLight(vehicle, thresholdDistance):
    check_arguments('withinDistanceToTrafficLight', vehicle, thresholdDistance)
    return closestTrafficLight(vehicle, thresholdDistance) is not None

def withinDistanceToRedYellowTrafficLight(vehicle, thresholdDistance):
    check_arguments('withinDistanceToRedYellowTrafficLight', vehicle, thresholdDistance)
    return getClosestTrafficLightStatus(vehicle, thresholdDistance) in ('yellow', 'red')
