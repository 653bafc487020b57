"""Who in a farm works on what, and for how long that is believed: by the database's clock, as machines disagree."""

from typing import Final

from conicoid_service.jobs.database import Database
from conicoid_service.jobs.outbox import Outbox
from conicoid_service.jobs.records import Claim, Unit
from conicoid_service.jobs.work import Work

# A worker renews what it renders every `executor.RENEW_S`, also while the object store is slow.
SILENCE_MS: Final = 20_000
# From a message's way into an empty queue to a worker's word of it.
UNHEARD_MS: Final = 10_000
# Queues are first in, first out: a unit sent so long before one that is being rendered was not overtaken, it was lost.
# Longer than a worker of two queues keeps a unit of one of them while it renders one of the other.
OVERTAKEN_MS: Final = 300_000


class Leases:
    """The units in a database; each step is one transaction, or two."""

    def __init__(self, database: Database, work: Work, outbox: Outbox) -> None:
        self._database, self._work, self._outbox = database, work, outbox

    def take(self, unit: Unit, *, redelivered: bool) -> Claim | None:
        """As `Work.take`; `redelivered` says that the broker knows that whoever had it is gone."""
        now = self._now_ms()
        return self._work.take(unit, now, lost_before_ms=now + 1 if redelivered else now - SILENCE_MS)

    def renew(self, claim: Claim) -> None:
        """Say that the unit is still being rendered here."""
        self._work.renew(claim, self._now_ms())

    def send(self, priority: int, limit: int) -> list[Unit]:
        """As `Outbox.take`."""
        return self._outbox.take(priority, limit, self._now_ms())

    def recall_silent(self) -> int:
        """Have units sent again of which their workers have not said anything for too long; how many they are."""
        return self._outbox.recall_running(self._now_ms() - SILENCE_MS)

    def recall_lost(self, priority: int, *, queue_is_empty: bool) -> int:
        """Have units sent again that the broker cannot have any more; how many they are."""
        newest = self._outbox.newest_taken(priority)
        overtaken = 0 if newest is None else newest - OVERTAKEN_MS
        before = self._now_ms() - UNHEARD_MS if queue_is_empty else overtaken
        return self._outbox.recall_sent(priority, max(before, overtaken))

    def _now_ms(self) -> int:
        self._database.read_clock()
        return self._database.now_ms()
