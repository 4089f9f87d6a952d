# The paper, Section "Expressions": y is not uniform over the unit box, but over its diagonal.
x = Range(0, 1)
y = (x, x)
ego = Object at y
