# The paper, Section "Basic Scenarios", "Mutations": `taxi = Car at (120, 300), facing 37 deg, ...`, its dots filled by
# the class, an ego that sees the taxi, and nothing else.
class Car:
    width: 2
    length: 4.5

taxi = Car at (120, 300), facing 37 deg, with color 'yellow'
ego = Car at (120, 290)
mutate taxi
