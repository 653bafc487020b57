"""Every error class has a code, every code a status and a line in docs/errors.md, and nothing else has one."""

import ast
import re
from collections.abc import Iterator

import pytest

import conicoid_service.errors  # noqa: F401  # its classes are looked for
from conicoid.errors import ConicoidError, DeviceError, KernelError, LimitError, Problem, SceneError
from conicoid_service.errors import QueueFullError, ReportedError
from conicoid_service.problems import STATUS, problem
from conicoid_service.worker import failure
from tests.checkout import ROOT

NEVER_SENT = {"settings", "store", "broker"}
FAMILIES = {"error"}


def documented() -> dict[str, str]:
    """Code to status, as docs/errors.md has them."""
    return dict(
        re.findall(r"^\| `([a-z-]+)` \| (\d+|–) \|", (ROOT / "docs/errors.md").read_text("utf-8"), re.MULTILINE)
    )


def codes_of_classes(of: type[ConicoidError] = ConicoidError) -> Iterator[str]:
    if of is not ReportedError:  # its code is another error's
        yield of.code
    for kind in of.__subclasses__():
        yield from codes_of_classes(kind)


def codes_in_the_engine() -> set[str]:
    """Every string in the engine that is a scene document's code."""
    trees = [ast.parse(path.read_text("utf-8")) for path in (ROOT / "cl/conicoid").rglob("*.py")]
    strings = {node.value for tree in trees for node in ast.walk(tree) if isinstance(node, ast.Constant)}
    return {value for value in strings if isinstance(value, str) and re.fullmatch(r"scene-[a-z-]+", value)}


def test_every_class_and_every_code_of_the_parser_is_documented_and_nothing_else() -> None:
    http = {"bad-request", "not-found", "method-not-allowed", "parameter"}
    assert set(documented()) == {*codes_of_classes(), *codes_in_the_engine(), *http}


@pytest.mark.parametrize("code", sorted(documented()))
def test_documented_status_is_the_one_that_is_sent(code: str) -> None:
    class Raised(ConicoidError):
        pass

    Raised.code = code
    if code in NEVER_SENT:
        assert code not in STATUS
        assert documented()[code] == "–"
    else:
        assert str(problem(Raised("x")).status_code) == documented()[code]


def test_only_scene_codes_rely_on_the_default_status() -> None:
    assert {code for code in documented() if code not in STATUS and not code.startswith("scene-")} == NEVER_SENT


ERRORS = [
    SceneError([Problem("a", "one", "scene-value"), Problem("b", "two", "scene-type")]),
    LimitError("pixels", 10, 11),
    DeviceError("none; install one"),
    KernelError("a.cl:3: no"),
    ConicoidError("something"),
]


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
def test_an_error_is_the_same_problem_whether_raised_here_or_reported_by_a_child(error: ConicoidError) -> None:
    report = failure(error)["failed"]
    assert problem(ReportedError.from_report(report)).body == problem(error).body


def test_an_error_that_passes_says_when_to_try_again() -> None:
    assert problem(QueueFullError("full")).headers["retry-after"] == "1"


def test_a_cost_beyond_64_bits_is_told_as_what_they_hold() -> None:
    told = problem(LimitError("quadrics", 10, 10**30)).body
    assert b"9223372036854775807" in told
    assert f"{10**30} quadrics asked".encode() in told
