"""Start-up check of a device's arithmetic: the error bounds hold only with a true fma and no contraction."""

import numpy as np

from conicoid.device import describe
from conicoid.errors import DeviceError
from conicoid.memory import Queue
from conicoid.program import build


def check_arithmetic(queue: Queue) -> None:
    """Raises DeviceError where fma rounds twice, a * b + c is fused or sums are re-associated against orders."""
    answer = np.full(4, np.nan)
    kernel = build(queue.context, ["dd.h", "probe.cl"]).probe_arithmetic
    a = 1 + 2.0**-30
    queue.run(kernel, 1, np.float64(a), queue.in_place(answer))
    if answer.tolist() != [2.0**-60, 0.0, 2.0**-60, a * 2.0**-90]:
        raise DeviceError(
            f"{describe(queue.device).label} does not compute a true fma without contraction (it answered "
            f"{answer.tolist()}); results would be wrong, so choose another device with CONICOID_DEVICE"
        )
