"""Who is next, and who is sent away."""

import pytest

from conicoid_service.errors import QueueFullError, StoppingError
from conicoid_service.line import Line
from conicoid_service.task import Task


def line(queue_length: int = 100, owner_queue_length: int = 100, processes: int = 1) -> Line:
    return Line("render", queue_length=queue_length, owner_queue_length=owner_queue_length, processes=processes)


def put(into: Line, *names: str, batch: bool = False) -> None:
    """Put requests in whose owners are the names' first letters."""
    for name in names:
        into.put(Task({"name": name}, owner=name[0], batch=batch))


def order(of: Line) -> list[str]:
    """The requests as they are served."""
    served = []
    while (task := of.get(0)) is not None:
        assert task.message is not None
        served.append(task.message["name"])
        of.done(task, 0.1)
    return served


def test_owners_take_turns_each_in_order_of_arrival() -> None:
    waiting = line()
    put(waiting, "a1", "a2", "a3", "b1", "b2", "c1")
    assert order(waiting) == ["a1", "b1", "c1", "a2", "b2", "a3"]


def test_interactive_requests_go_before_batches_whenever_they_came() -> None:
    waiting = line()
    put(waiting, "a1", "b1", batch=True)
    put(waiting, "a2", "a3")
    assert order(waiting) == ["a2", "a3", "a1", "b1"]


def test_batches_never_fill_the_line() -> None:
    waiting = line(queue_length=0)
    put(waiting, "a1", "a2", "a3", batch=True)
    put(waiting, "a4")
    with pytest.raises(QueueFullError):
        put(waiting, "b1")


def test_one_owner_fills_its_own_places_only_and_nobody_has_unlimited() -> None:
    waiting = line(owner_queue_length=1)
    put(waiting, "a1", "a2")
    with pytest.raises(QueueFullError, match="of this API key"):
        put(waiting, "a3")
    put(waiting, "b1")
    for _ in range(5):
        waiting.put(Task({"name": "x"}))
    assert waiting.waiting().refusals == 1


@pytest.mark.parametrize(("seconds", "expected"), [(0.001, 1), (5, 13), (100, 60)])
def test_retry_after_is_the_time_in_which_those_who_wait_are_served(seconds: float, expected: int) -> None:
    waiting = line(queue_length=3, processes=2)
    for name in ("a1", "a2"):
        put(waiting, name)
        task = waiting.get(0)
        assert task
        waiting.done(task, seconds)
    put(waiting, "a1", "a2", "a3", "a4", "a5")
    with pytest.raises(QueueFullError) as refused:
        put(waiting, "a6")
    assert refused.value.retry_after_s == expected


def test_who_is_cancelled_leaves_the_line_at_once() -> None:
    waiting = line(queue_length=0)
    task = Task({"name": "a1"})
    waiting.put(task)
    task.future.cancel()
    assert (waiting.waiting().interactive, waiting.waiting().interactive_age_s) == (0, 0.0)
    put(waiting, "b1")
    assert order(waiting) == ["b1"]


def test_a_closed_line_gives_back_who_waited_and_lets_nobody_in() -> None:
    waiting = line()
    put(waiting, "a1")
    put(waiting, "b1", batch=True)
    assert len(waiting.close()) == 2
    assert waiting.get(60) is None
    with pytest.raises(StoppingError):
        put(waiting, "a2")
