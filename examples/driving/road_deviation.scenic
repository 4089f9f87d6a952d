# dialect: scenic-3
# Cars that do not stand along the road, and what that means for their headings.
model scenic.domains.driving.model

ego = new Car with roadDeviation Range(-5, 5) deg
left = new Car left of ego by Range(0.5, 2), facing Range(-5, 5) deg relative to roadDirection, with regionContainedIn everywhere
require (relative heading of left from ego) < 30 deg
require (apparent heading of left) > -60 deg
param deviation = relative heading of left from ego
