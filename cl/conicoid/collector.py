"""Python's cycle collector, kept off while a JSON tree is built."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def paused_collector() -> Iterator[None]:
    """Keep the cycle collector off: a JSON tree has no cycles, and looking for them more than doubles the time.

    Threads may overlap in it: the first to leave turns the collector on again, which only costs the others time.
    """
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()
