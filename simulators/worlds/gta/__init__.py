"""The GTA-like world: `model.scenic`, and the constants that it takes from here (`data`)."""
