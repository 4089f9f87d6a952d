"""`scenic-ref check`: whether a program is one."""

from __future__ import annotations

import typer

from .options import (
    DEFAULT_FUEL,
    DebugOption,
    DialectOption,
    FileArgument,
    FuelOption,
    ModelOption,
    ParamOption,
    ProfileOption,
    ReadingOption,
    SeedOption,
    TrustOption,
    read_source,
)


def check(
    context: typer.Context,
    file: FileArgument,
    seed: SeedOption = 0,
    profile: ProfileOption = "paper",
    reading: ReadingOption = None,
    dialect: DialectOption = None,
    model: ModelOption = None,
    param: ParamOption = None,
    fuel: FuelOption = DEFAULT_FUEL,
    trust: TrustOption = False,
    debug: DebugOption = False,
) -> None:
    """Parse a program, check it, and run it through once; prints "ok" or the error."""
    session = context.obj
    session.seed = seed
    source = read_source(
        session, file, profile=profile, reading=reading, dialect=dialect, model=model, param=param, fuel=fuel, trust=trust
    )
    scenario = source.load()
    assert scenario.rehearsed
    print("ok")
