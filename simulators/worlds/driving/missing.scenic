# What models of other simulators have that only these can do: it is refused by its name.

def refused(name, instead):
    raise NotImplementedError(f'{name} needs its simulator, which this reference does not know: {instead}')
