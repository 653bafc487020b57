"""A moving line on a terminal while work lasts, and no trace of it afterwards."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def progress(text: str, total: int | None = None) -> Iterator[Callable[[], object]]:
    """Show `text` and the time; with `total`, also how much of it is done: call what is given once for each part."""
    if sys.stderr is None or not sys.stderr.isatty():
        yield lambda: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    first = [SpinnerColumn()] if total is None else [BarColumn(), MofNCompleteColumn()]
    columns = [*first, TextColumn("{task.description}", markup=False), TimeElapsedColumn()]
    with Progress(*columns, console=Console(stderr=True), transient=True) as shown:
        task = shown.add_task(text, total=total)
        yield lambda: shown.advance(task)
