from gta import *
param time = 12 * 60
param weather = 'EXTRASUNNY'
ego = new EgoCar at -628.7878 @ -540.6067, facing -359.1691 deg
new Car at -625.4444 @ -530.7654, facing 8.2872 deg, with model MODELS['DOMINATOR'], with color tuple([187 / 255, 162 / 255, 157 / 255])
mutate
