"""Malformed scene documents as data: each has one mistake, at a known place, with a known code."""

from tests.malformed import batches, cameras, npz, outputs, quadrics, sets, texts
from tests.malformed.case import Case

CASES: list[Case] = [*texts.CASES, *quadrics.CASES, *sets.CASES, *npz.CASES, *cameras.CASES, *outputs.CASES]

BATCHES = batches.BATCHES

__all__ = ["BATCHES", "CASES", "Case"]
