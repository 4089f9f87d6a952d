# dialect: pldi19
# The paper, Appendix "Gallery of Scenarios", "Adding Noise to a Scene", as printed.
from scenic.simulators.gta.model import *

param time = 12 * 60    # noon
param weather = 'EXTRASUNNY'

ego = EgoCar at -628.7878 @ -540.6067,
             facing -359.1691 deg

Car at -625.4444 @ -530.7654, facing 8.2872 deg,
    with model CarModel.models['DOMINATOR'],
    with color CarColor.byteToReal([187, 162, 157])

mutate
