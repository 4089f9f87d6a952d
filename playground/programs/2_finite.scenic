# Finitely many outcomes: histograms with the exact law
# Histogram shows what follows exactly, beside the scenes.
weather = Uniform('sun', 'rain', 'snow')
gap = Discrete({5: 2, 10: 3, 20: 1})     # metres

ego = Object at (0, 0),
    with width 2, with length 4.5
lead = Object ahead of ego by gap,
    with width 2, with length Uniform(4.5, 12)

# Nobody follows that closely in snow.
require weather != 'snow' or gap > 5
# A coin decides whether lorries are left out.
require[0.5] lead.length < 10

param weather = weather
