"""Every error the engine raises, on one page.

Each class has a stable `code`, which the service sends to clients and `docs/errors.md` explains.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

_LARGEST: Final = 2**63 - 1  # integer that a message can hold


class ConicoidError(Exception):
    """Base of all of Conicoid's own errors; the message is one readable paragraph."""

    code = "error"


@dataclass(frozen=True)
class Problem:
    """One thing wrong with a document: where, what, the rule and the remedy.

    Attributes:
        pointer: place in the document, as in `quadrics[3].radius`; empty for the whole document.
        message: value, rule and remedy: `-1 is not > 0; give a positive radius`.
        code: stable code of this kind of problem, as in `scene-value`.
    """

    pointer: str
    message: str
    code: str

    def __str__(self) -> str:
        place = f"{self.pointer}: " if self.pointer else ""
        return f"{place}{self.message} [{self.code}]"


class SceneError(ConicoidError):
    """The scene document breaks the contract; `problems` says where (at least one)."""

    code = "scene-invalid"

    def __init__(self, problems: Sequence[Problem]) -> None:
        super().__init__("\n".join(map(str, problems)))
        self.problems = tuple(problems)
        self.code = problems[0].code


class LimitError(ConicoidError):
    """More work than a limit allows, refused before anything is allocated.

    Attributes:
        what: that is limited.
        limit: how much may be asked.
        asked: how much was, if 64 bits hold it, else what they do.
    """

    code = "limit"

    def __init__(self, what: str, limit: int, asked: int) -> None:
        super().__init__(f"{asked} {what} asked, the limit is {limit}; ask for less or raise the limit in the settings")
        self.what, self.limit, self.asked = what, limit, min(asked, _LARGEST)


class CameraRangeError(ConicoidError):
    """What follows from the camera's numbers is beyond binary64, in which rays are cast."""

    code = "camera-range"


class QuadricsFileError(ConicoidError):
    """Quadrics that were stored are damaged, or not what they should be."""

    code = "quadrics-file"


class DeviceError(ConicoidError):
    """No usable OpenCL device, or the one that was asked for is not there."""

    code = "device-missing"


class KernelError(DeviceError):
    """A kernel did not build; the message holds the compiler's log with file and line."""

    code = "kernel-build"
