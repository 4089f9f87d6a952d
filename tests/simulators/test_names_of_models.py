"""The names for which a world model is suggested are names that it gives."""

from __future__ import annotations

import pytest
from scenic_ref.api import loads
from scenic_ref.semantics.store.errors import RunError
from scenic_ref.simulators.worlds.names import NAMES_OF_MODELS


@pytest.mark.parametrize("model", NAMES_OF_MODELS)
def test_a_model_has_the_names_for_which_it_is_suggested(model: str) -> None:
    names = NAMES_OF_MODELS[model].split()
    text = f"model {model}\nego = Object at (0, 0), with requireVisible False, with regionContainedIn everywhere\nfound = [{', '.join(names)}]\n"
    loads(text).rehearse()
    with pytest.raises(RunError) as refused:
        loads(f"ego = {names[0].lower()}\n").rehearse()
    assert names[0] in refused.value.hint or model in refused.value.hint
