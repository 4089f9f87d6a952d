"""The service layer: programs as they are asked for, and their scenes and simulations, drawn by this process or by several."""
