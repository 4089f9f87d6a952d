"""Behaviors, monitors and conditions over time as Python code: the same simulations as the machine's, faster."""
