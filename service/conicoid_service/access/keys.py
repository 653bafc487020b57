"""API keys: read from a setting, kept as digests, compared in constant time."""

import hashlib
import hmac
import re
from dataclasses import dataclass, field
from typing import Final, Self

_ENTRY: Final = re.compile(r"(?:(?P<name>[a-z][a-z0-9_-]{0,31})=(?!=))?(?P<key>[!-~]+)")
_NAME_ALONE: Final = re.compile(r"[a-z][a-z0-9_-]{0,31}=+")
_HASHED: Final = "sha256:"
_SHORTEST_PADDED: Final = 16  # characters of a key that looks like a name without one


@dataclass(frozen=True)
class Key:
    """One key that is let in.

    Attributes:
        owner: the name that it was given, or the start of its digest.
        digest: its SHA-256; the key itself is not kept.
    """

    owner: str
    digest: bytes = field(repr=False)


@dataclass(frozen=True)
class Keys:
    """All keys that are let in; none means that everybody is."""

    entries: tuple[Key, ...] = ()

    @classmethod
    def parse(cls, text: str) -> Self:
        """Entries `KEY`, `sha256:HEX`, `NAME=KEY` or `NAME=sha256:HEX` between commas or white space.

        Raises:
            ValueError: it is not that; the message tells the entry's place and never the entry.
        """
        words = text.replace(",", " ").split()
        if not words:
            raise ValueError("it has no entry; give a key, or leave the setting out")
        entries = [_key(word, place) for place, word in enumerate(words, 1)]
        for place, entry in enumerate(entries, 1):
            if entry.digest in [before.digest for before in entries[: place - 1]]:
                raise ValueError(f"entry {place} has the key of another; one key belongs to one owner, once")
        return cls(tuple(entries))

    def owner_of(self, key: bytes) -> str | None:
        """Whose key it is; None for nobody's. Takes as long for one as for another."""
        digest, owner = hashlib.sha256(key).digest(), None
        for entry in self.entries:
            if hmac.compare_digest(entry.digest, digest):
                owner = entry.owner
        return owner

    def __bool__(self) -> bool:
        return bool(self.entries)


def _key(word: str, place: int) -> Key:
    entry = _ENTRY.fullmatch(word)
    if entry is None:
        raise ValueError(f"entry {place} has characters that no header takes; use printable ASCII")
    if _NAME_ALONE.fullmatch(word) and (len(word) < _SHORTEST_PADDED or len(word) % 4):
        raise ValueError(f"entry {place} is a name without a key; write NAME=KEY")
    digest = _digest(entry["key"], place)
    return Key(entry["name"] or digest.hex()[:12], digest)


def _digest(key: str, place: int) -> bytes:
    if not key.startswith(_HASHED):
        return hashlib.sha256(key.encode()).digest()
    if not re.fullmatch(r"[0-9A-Fa-f]{64}", key.removeprefix(_HASHED)):
        raise ValueError(f"entry {place} is no SHA-256; write sha256: and 64 hexadecimal digits")
    return bytes.fromhex(key.removeprefix(_HASHED))
