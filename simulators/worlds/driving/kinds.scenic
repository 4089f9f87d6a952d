# What makes an object take the actions of vehicles, or of pedestrians, as a further superclass.

class Steers:
    drives: True

class Walks:
    walks: True
