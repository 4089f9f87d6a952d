# Finitely many outcomes: histograms with the exact law
# Choose params.weather or lead.length under Histogram: bars of scenes beside the exact law.
weather = Uniform('sun', 'rain', 'snow')
gap = Discrete({5: 2, 10: 3, 20: 1})
ego = Object at (0, 0), with width 2, with length 4.5
lead = Object ahead of ego by gap, with width 2, with length Uniform(4.5, 12)

require weather != 'snow' or gap > 5        # nobody follows that closely in snow
require[0.5] lead.length < 10               # a coin decides whether lorries are left out

param weather = weather
