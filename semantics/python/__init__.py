"""What the language takes over from Python: expressions, calls, functions, control, comprehensions, classes, imports, the parts of the library."""
