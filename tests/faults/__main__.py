"""`python -m tests.faults`: how long a campaign takes to find each of the wrong machines, unaided.

Each machine is put to `scenic-ref fuzz`, as any other implementation is, until the first finding is confirmed, or the time is over.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from scenic_ref.conformance.fuzz.examination import OUR_FAULT

from .faults import FAULTS, Fault, wrong_machine


def first_finding(fault: Fault, limit: str, seed: int, workers: int) -> tuple[float, str]:
    """The seconds until the first finding, and what was said of it; "" if there was none."""
    with tempfile.TemporaryDirectory() as folder:
        machine = wrong_machine(fault, Path(folder))
        served = f"env PYTHONPATH={machine} {sys.executable} -P -m scenic_ref.conformance.implementations.harness_server"
        command = [sys.executable, "-m", "scenic_ref", "fuzz", "--impl", served, "--time", limit, "--seed", str(seed), "-o", f"{folder}/campaign"]
        began = time.monotonic()
        with subprocess.Popen([*command, "--workers", str(workers)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as campaign:
            told: list[str] = []
            found = next((line for line in lines(campaign, told) if line.startswith("program ") and OUR_FAULT not in line), "")
            took = time.monotonic() - began
            campaign.terminate()
            campaign.communicate()
        if any(OUR_FAULT in line for line in told) or (not found and campaign.returncode not in (0, 1)):
            raise SystemExit("\n".join(told))  # a fault of the judge, or it never began
    return took, found


def lines(campaign: subprocess.Popen[str], told: list[str]) -> Iterator[str]:
    """What the campaign tells, line by line, which is also added to `told`."""
    assert campaign.stderr is not None
    for line in campaign.stderr:
        told.append(line.strip())
        yield line.strip()


def main() -> int:
    """Each machine, some at a time; the exit code is 1 if one was not found."""
    parser = argparse.ArgumentParser(prog="python -m tests.faults", description=__doc__)
    parser.add_argument("--time", default="10m", help="how long a campaign may take (default: 10m)")
    parser.add_argument("--seed", type=int, default=0, help="the seed of the campaigns (default: 0)")
    parser.add_argument("--workers", type=int, default=2, help="the processes of a campaign (default: 2, as of fuzz)")
    parser.add_argument("--jobs", type=int, default=1, help="campaigns at a time (default: 1)")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"only these machines: {'; '.join(fault.name for fault in FAULTS)}")
    given = parser.parse_args()
    if unknown := set(given.names) - {fault.name for fault in FAULTS}:
        parser.error(f"there is no {', '.join(map(repr, sorted(unknown)))}")
    chosen = [fault for fault in FAULTS if not given.names or fault.name in given.names]
    missed = 0

    def tried(fault: Fault) -> tuple[float, str]:
        return first_finding(fault, given.time, given.seed, given.workers)

    with ThreadPoolExecutor(given.jobs) as pool:
        for fault, (took, found) in zip(chosen, pool.map(tried, chosen), strict=True):
            missed += not found
            print(f"{fault.name}: {f'{took:.0f} s, {found}' if found else f'not found in {given.time}'}", flush=True)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
