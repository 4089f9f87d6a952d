# Controllers of vehicles: what the released library gives under these names, measured there (tests/released/test_controllers.py).
# A controller is asked once in each time step, of `dt` seconds, and remembers the errors that it was told.

from scenic.domains.driving.arguments import check_arguments

__all__ = ['PIDLongitudinalController', 'PIDLateralController']

REMEMBERED = 10  # errors that the longitudinal controller adds up
LARGEST_SUM = 20  # of the errors that the lateral one has added up, in metre seconds

def clipped(signal):
    return max(-1.0, min(1.0, signal))

# From the error in speed (target minus own, m/s): throttle from 0 to 1, or where it is negative brake from 0 to -1.
class PIDLongitudinalController(object):
    def __init__(self, K_P=0.5, K_D=0.1, K_I=0.2, dt=0.1):
        check_arguments('PIDLongitudinalController', K_P, K_D, K_I, dt)
        self.gains = K_P, K_D, K_I
        self.dt = dt
        self.errors = []

    def run_step(self, speed_error):
        check_arguments('PIDLongitudinalController.run_step', speed_error)
        proportional, derivative, integral = self.gains
        self.errors = (self.errors + [speed_error])[-REMEMBERED:]
        signal = proportional * speed_error
        if len(self.errors) > 1:
            signal += derivative * (speed_error - self.errors[-2]) / self.dt + integral * sum(self.errors) * self.dt
        return clipped(signal)

# From the cross-track error (metres to the right of the path): steering from -1 (left) to 1 (right).
class PIDLateralController(object):
    def __init__(self, K_P=0.3, K_D=0.2, K_I=0, dt=0.1):
        check_arguments('PIDLateralController', K_P, K_D, K_I, dt)
        self.gains = K_P, K_D, K_I
        self.dt = dt
        self.last = 0
        self.total = 0

    def run_step(self, cte):
        check_arguments('PIDLateralController.run_step', cte)
        proportional, derivative, integral = self.gains
        self.total = max(-LARGEST_SUM, min(LARGEST_SUM, self.total + cte * self.dt))
        signal = proportional * cte + derivative * (cte - self.last) / self.dt + integral * self.total
        self.last = cte
        return clipped(signal)

# The two controllers of an agent, whose lateral gains depend on what they are for; those of the released Newtonian simulator.
def pair(agent, ofCar, ofOthers):
    step = simulation().timestep
    if agent.isCar:
        return PIDLongitudinalController(0.5, 0.1, 0.7, step), PIDLateralController(*ofCar, step)
    return PIDLongitudinalController(0.25, 0.025, 0, step), PIDLateralController(*ofOthers, step)

# What `simulation()` has under these names.
def getLaneFollowingControllers(agent):
    check_arguments('getLaneFollowingControllers', agent)
    return pair(agent, (0.1, 0.1, 0.02), (0.2, 0.1, 0))

def getTurningControllers(agent):
    check_arguments('getTurningControllers', agent)
    return pair(agent, (0.2, 0.2, 0.2), (0.4, 0.1, 0))

def getLaneChangingControllers(agent):
    check_arguments('getLaneChangingControllers', agent)
    return pair(agent, (0.2, 0.2, 0.02), (0.1, 0.3, 0))
