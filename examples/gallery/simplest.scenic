# The paper, Appendix "Gallery of Scenarios", "The Simplest Possible Scenario", in the syntax of Section 4.
model scenic.simulators.gta.model

ego = Car
Car
