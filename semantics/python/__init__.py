"""The parts of the language taken over from Python: expressions, calls, functions, control, comprehensions,
classes, imports, the library.
"""
