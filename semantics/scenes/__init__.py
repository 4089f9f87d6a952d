"""The parts of a scene: object definitions, specifiers, Algorithm 1, operators, statements, mutation and
termination.
"""
