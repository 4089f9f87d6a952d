"""What a scene is made of: object definitions, specifiers, Algorithm 1, operators, statements, mutation and termination."""
