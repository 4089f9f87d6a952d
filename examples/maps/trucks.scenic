# Trucks on a map of one's own: where they may be and which way they face, the map says.

param map = localPath('yard.geojson')
model site_map

class Truck:
    width: 2.5
    length: 7
    position: Point in regions['lane']
    heading: directions at self.position
    requireVisible: False

ego = Truck
Truck
charging = Object in regions['chargers'], with width 1, with length 1, with requireVisible False
beside = Object on regions['wall'], with width 0.4, with length 2, with requireVisible False
require (distance from charging to beside) > 25
