# The paper, Section "Expressions": `Car at (120, 70), facing 30 deg relative to roadDirection`, with a road direction of our own.
roadDirection = VectorField('roadDirection', lambda position: position.x * 0.25 deg)

class Car:
    width: 2
    length: 4.5

ego = Car at (120, 70), facing 30 deg relative to roadDirection
