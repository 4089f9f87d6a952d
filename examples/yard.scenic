# Five lorries in a yard that holds them only just: about two runs in a million are accepted.
#     scenic-ref run examples/yard.scenic -n 16 --backend smc --plot yard.png
yard = PolygonalRegion([0@0, 14@0, 14@6, 6@6, 6@10, 0@10])
workspace = Workspace(yard)

def lorry():
    return Object in yard, facing Range(-10, 10) deg, with width 2, with length 4.5, with requireVisible False

ego = lorry()
for i in range(4):
    lorry()
