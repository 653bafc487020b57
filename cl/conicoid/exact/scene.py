"""A scene in exact arithmetic: any pixel, decided."""

from collections.abc import Iterable
from functools import cached_property

import numpy as np
from flint import fmpz

from conicoid.exact.forms import ExactForms
from conicoid.exact.hits import Depths, Hit, kept_hits
from conicoid.exact.pixel import ExactPixel
from conicoid.exact.planes import FlatPieces, SeenPlane
from conicoid.exact.polynomial import Linear
from conicoid.exact.quadric import ExactQuadric
from conicoid.exact.rationals import exact, sign
from conicoid.exact.rays import ExactRays
from conicoid.exact.surd import compare
from conicoid.scene import Channel, Scene


class ExactScene:
    """The exact image of a scene, pixel by pixel; each quadric is set up when it is first asked for."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._quadrics: dict[int, ExactQuadric] = {}

    def pixel(self, i: int, j: int, candidates: Iterable[int]) -> ExactPixel | None:
        """What is seen at column i, row j of the whole image, None for a miss.

        `candidates` are the indices of the quadrics that may matter there, in any order.
        """
        u, v = fmpz(2 * i + 1), fmpz(2 * j + 1)
        first: Hit | None = None
        winner, hits = -1, list[Hit]()
        for index in sorted(set(candidates)):
            found = kept_hits(self._quadric(index), self._depths, u, v)
            if found and (first is None or compare(_nearest(found).t, first.t) < 0):
                winner, hits, first = index, found, _nearest(found)
        if first is None:
            return None
        outward = self._scene.output.normal_side == "outward"
        quadric = self._quadric(winner)
        return ExactPixel(winner, first.kind, self._rays, quadric, outward, first, _farthest(hits), u, v)

    def values(self, i: int, j: int, candidates: Iterable[int], channels: Iterable[Channel]) -> dict[str, float]:
        """What a pixel's planes hold, by EXR channel name: background depth and zeros on a miss."""
        pixel = self.pixel(i, j, candidates)
        result: dict[str, float] = {}
        for channel in channels:
            result |= self.channel(channel, pixel)
        return result

    def channel(self, channel: Channel, pixel: ExactPixel | None) -> dict[str, float]:
        """What one channel's planes hold where `pixel` is seen."""
        match channel:
            case "Z":
                value = pixel.z if pixel else self._background
            case "T":
                value = pixel.t if pixel else self._background
            case "ZBack":
                value = pixel.z_back if pixel else self._background
            case "N":
                return _by_axis("N", pixel.normal if pixel else None)
            case "P":
                return _by_axis("P", pixel.position if pixel else None)
            case "id":
                value = int(self._scene.quadrics.id[pixel.quadric]) if pixel else 0
            case "A":
                value = 1.0 if pixel else 0.0
        return {channel: value}

    def sign_fixed(self, quadric: int) -> int:
        """Sign of F'DF: f at the eye (pinhole), or the quadratic form of the rays' direction (orthographic)."""
        exact_quadric = self._quadric(quadric)
        return sign((exact_quadric.a if self._rays.orthographic else exact_quadric.c).one)

    def forms(self, quadric: int) -> ExactForms:
        """The polynomials in the pixel that decide one quadric."""
        return self._quadric(quadric).forms()

    def same_surface(self, first: int, kind: int, second: int, other_kind: int) -> bool:
        """Whether two surfaces, or planes of caps, have the same equation in the world.

        Then each root of the one is a root of the other at every pixel, with equal t.
        """
        return self.surface_key(first, kind) == self.surface_key(second, other_kind)

    def surface_key(self, quadric: int, kind: int) -> tuple[fmpz, ...]:
        """An equation of one surface, or of a cap's plane, in a form that equal sets of points share."""
        return self._quadric(quadric).surface_key(kind)

    def flat_pieces(self, quadric: int) -> FlatPieces:
        """The planes and caps of one quadric."""
        return self._quadric(quadric).flat_pieces(self._depth_planes)

    def _quadric(self, index: int) -> ExactQuadric:
        if index not in self._quadrics:
            self._quadrics[index] = ExactQuadric(self._rays, self._scene.quadrics, index)
        return self._quadrics[index]

    @cached_property
    def _rays(self) -> ExactRays:
        return ExactRays(self._scene.camera, self._scene.output)

    @cached_property
    def _depths(self) -> Depths:
        near, far = float(self._scene.camera.near), float(self._scene.camera.far)
        return Depths(exact(near), None if far == float("inf") else exact(far))

    @cached_property
    def _depth_planes(self) -> list[SeenPlane]:
        near, far = self._depths
        beyond = [self._rays.depth_beyond(near)] if near else []
        if far is not None:
            fixed, moving = self._rays.depth_beyond(far)
            beyond.append(SeenPlane(-fixed, Linear(*[-value for value in moving])))
        return beyond

    @cached_property
    def _background(self) -> float:
        with np.errstate(over="ignore"):
            return float(np.float32(self._scene.output.background_depth))


def _nearest(hits: list[Hit]) -> Hit:
    """The smallest t; the first listed of equals, which is the order of kinds."""
    nearest = hits[0]
    for hit in hits[1:]:
        if compare(hit.t, nearest.t) < 0:
            nearest = hit
    return nearest


def _farthest(hits: list[Hit]) -> Hit:
    farthest = hits[0]
    for hit in hits[1:]:
        if compare(hit.t, farthest.t) > 0:
            farthest = hit
    return farthest


def _by_axis(name: str, vector: tuple[float, float, float] | None) -> dict[str, float]:
    return dict(zip((f"{name}.X", f"{name}.Y", f"{name}.Z"), vector or (0.0, 0.0, 0.0), strict=True))
