# The paper, Section "Data Types": each instance has a weight drawn independently.
class Parcel:
    weight: Range(1, 5)

ego = Parcel at (0, 0)
Parcel at (2, 0)
