"""The command line of the stress suite."""

from __future__ import annotations

import signal
import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from functools import partial
from multiprocessing import Pool
from pathlib import Path

import click

import compoundkin as ck
from tests.stress.misuse import misused
from tests.stress.mutated_files import mutated
from tests.stress.outcome import Outcome
from tests.stress.sketch import Placed
from tests.stress.trial import KINDS, drawn_case, kind_of, tried

JOBS = click.option("--jobs", default=1, show_default=True, help="So many processes.")
COUNT = click.option("--count", default=300, show_default=True, help="So many cases.")
SEED = click.option("--seed", default=1, show_default=True, help="The cases of this seed.")
FIRST = click.option("--first", default=0, show_default=True, help="From this case on.")


@click.group(invoke_without_command=True)
@COUNT
@SEED
@FIRST
@JOBS
@click.option("--case", "one", type=int, help="This case alone, told in full.")
@click.option("--small", is_flag=True, help="Few links and poses, as in the test command.")
@click.option("--kind", type=click.Choice(["all", *KINDS]), default="even", show_default=True, help="What is tried.")
@click.option("--verify", "verified", is_flag=True, help="`verify` must pass wherever nothing else is wrong.")
@click.option(
    "--save", "folder", type=click.Path(path_type=Path), help="Write faulty cases (or the one) as files here."
)
@click.pass_context
def main(
    context: click.Context,
    count: int,
    seed: int,
    first: int,
    jobs: int,
    one: int | None,
    small: bool,
    kind: str,
    verified: bool,
    folder: Path | None,
) -> None:
    """Hold random mechanisms against the suite's own equations and continuation."""
    if context.invoked_subcommand:
        return
    numbers = [one] if one is not None else range(first, first + count)
    again = f"{'--small ' if small else ''}--kind {kind} --seed {seed} --case NUMBER"
    saving = partial(save, folder, seed, small, kind) if folder else None
    trial = partial(tried, seed, small=small, verified=verified, kind=kind)
    sys.exit(1 if run(trial, numbers, jobs, again, saving) else 0)


@main.command()
@COUNT
@SEED
@FIRST
@JOBS
def files(count: int, seed: int, first: int, jobs: int) -> None:
    """Change catalog files at random: reading and solving them answer or say what is wrong."""
    sys.exit(
        1
        if run(
            partial(mutated, seed), range(first, first + count), jobs, f"files --seed {seed} --first NUMBER --count 1"
        )
        else 0
    )


@main.command()
@COUNT
@SEED
@FIRST
@JOBS
def misuse(count: int, seed: int, first: int, jobs: int) -> None:
    """Call public functions with what they are not for: only the package's own errors may come of it."""
    sys.exit(
        1
        if run(
            partial(misused, seed), range(first, first + count), jobs, f"misuse --seed {seed} --first NUMBER --count 1"
        )
        else 0
    )


def run(
    trial: partial[Outcome], numbers: Iterable[int], jobs: int, again: str, saving: partial[None] | None = None
) -> int:
    """Run the cases, telling faults as they come and the statistics at the end, or when interrupted."""
    total, faulty, done, began = Counter[str](), 0, 0, time.perf_counter()
    slowest = Outcome(-1)
    numbers = list(numbers)
    try:
        for outcome in outcomes(trial, numbers, jobs):
            done += 1
            total.update(outcome.counts)
            slowest = max(slowest, outcome, key=lambda o: o.seconds)
            for fault in outcome.faults:
                total[f"fault {fault.split(':')[0]}"] += 1
                click.echo(f"case {outcome.number}: {fault}")
            if outcome.faults:
                faulty += 1
                click.echo(f"    python -m tests.stress {again.replace('NUMBER', str(outcome.number))}")
            if saving and (outcome.faults or len(numbers) == 1):
                saving(outcome.number)
            if sys.stderr.isatty() or done % 200 == 0:
                click.echo(f"\r{done} of {len(numbers)}, {faulty} faulty", err=True, nl=not sys.stderr.isatty())
    except KeyboardInterrupt:
        click.echo("interrupted", err=True)
    for name, number in sorted(total.items()):
        click.echo(f"{name:32} {number:g}")
    click.echo(f"slowest: case {slowest.number}, {slowest.seconds:.2f} s")
    click.echo(f"{done} cases in {time.perf_counter() - began:.1f} s, {faulty} faulty")
    return faulty


def outcomes(trial: partial[Outcome], numbers: list[int], jobs: int) -> Iterator[Outcome]:
    if jobs == 1:
        yield from map(trial, numbers)
        return
    with Pool(jobs, initializer=partial(signal.signal, signal.SIGINT, signal.SIG_IGN)) as pool:
        yield from pool.imap_unordered(trial, numbers, chunksize=4)


def save(folder: Path, seed: int, small: bool, kind: str, number: int) -> None:
    """Write a case as a mechanism file with its values; one with a profile by formula is not written."""
    kind = kind_of(number, kind)
    if kind == "stacked":
        return
    case = drawn_case(seed, number, small, kind)
    placed = Placed(case.sketch)
    mechanism = placed.mechanism(f"stress {seed} {number}")
    values = case.values(placed.values())
    drives = [ck.drive(d.link, on=d.on, pair=d.pair, name=d.name, values=values[d.name]) for d in case.sketch.drivers]
    folder.mkdir(parents=True, exist_ok=True)
    try:
        ck.save(mechanism.replace(*drives), str(folder / f"case_{seed}_{number}.toml"))
    except ck.errors.CompoundkinError as error:
        click.echo(f"case {number} is not saved: {error}", err=True)
