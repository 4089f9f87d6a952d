"""What writes or reads a file: scenes, recordings of simulations, tables, pictures, movies, saved states."""
