"""The state of the machine and what one step can say: configurations, outcomes, scopes, values, kinds, classes, draws, the door for host code."""
