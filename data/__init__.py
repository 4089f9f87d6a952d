"""Readers and writers of files: scenes, recordings of simulations, tables, pictures, movies, saved states."""
