# The paper, Appendix "Gallery of Scenarios", "A Platoon, in Daytime", in the syntax of Section 4.
model scenic.simulators.gta.model

param time = Range(8, 20) * 60    # 8 am to 8 pm
ego = Car with viewDistance 60
c2 = Car visible
platoon = createPlatoonAt(c2, 5, dist=Range(2, 8))
