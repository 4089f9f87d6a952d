"""Pictures of scenes, simulations and maps, seen from above."""
