# What rejects how often?
# The margin says where attempts fail, Rejections how often.
yard = PolygonalRegion([0@0, 16@0, 16@8, 8@8, 8@14, 0@14])
workspace = Workspace(yard)

def lorry():
    return Object in yard, facing Range(-10, 10) deg,
        with width 2, with length 4.5, with requireVisible False

ego = lorry()
for i in range(2):
    lorry()
require ego.position.y < 5
