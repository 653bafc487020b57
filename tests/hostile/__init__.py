"""Hostile requests as data: bytes for a socket, and the statuses that they may be answered with."""

from tests.hostile import archives, bodies, documents, framing, jobs, paths
from tests.hostile.case import Hostile

CASES: list[Hostile] = [*documents.CASES, *archives.CASES, *bodies.CASES, *framing.CASES, *jobs.CASES, *paths.CASES]

__all__ = ["CASES", "Hostile"]
