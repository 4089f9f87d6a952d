"""The dynamic constructs: behaviors, monitors, interrupts, guards, scenarios, and the policy's seven steps (paper, "Dynamic Constructs")."""
