"""Room for files that may be wanted again: bounded, and whoever was not used for longest goes first."""

from collections import OrderedDict
from typing import Final, Generic, Protocol, TypeVar

from conicoid_service.blob import Blob

# Each holds a descriptor, and a process may often have no more than 1,024 of them.
MOST: Final = 256


class _InFile(Protocol):
    @property
    def blob(self) -> Blob: ...


T = TypeVar("T", bound=_InFile)


class Recent(Generic[T]):
    """Items by their keys, `MOST` at most and as many bytes of files as a limit allows. For one thread."""

    def __init__(self, limit: int) -> None:
        self.limit = limit
        self._items: OrderedDict[str, T] = OrderedDict()

    def put(self, key: str, item: T) -> bool:
        """Take an item over, in place of one with the same key; False, with its file closed, if it is too large."""
        size = len(item.blob)
        if size > self.limit:
            item.blob.close()
            return False
        self.drop(key)
        while self._items and (len(self._items) == MOST or size + self.size > self.limit):
            self.drop(next(iter(self._items)))
        self._items[key] = item
        return True

    def get(self, key: str) -> T | None:
        """The item, which now is the one that was used last; its file stays the room's."""
        if key in self._items:
            self._items.move_to_end(key)
        return self._items.get(key)

    def drop(self, key: str) -> None:
        """Give an item up, if it is there; who shares its file goes on with it."""
        if key in self._items:
            self._items.pop(key).blob.close()

    def close(self) -> None:
        """Give all of them up."""
        for key in list(self._items):
            self.drop(key)

    @property
    def size(self) -> int:
        """Bytes of all files."""
        return sum(len(item.blob) for item in self._items.values())
