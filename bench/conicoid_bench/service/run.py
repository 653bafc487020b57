"""All of `conicoid bench service`: starts, every compression, the same request again, several clients."""

import json
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from statistics import median
from typing import Any, Final

import numpy as np
import OpenEXR

from conicoid.document import parse
from conicoid.engine import Renderer as Engine
from conicoid_bench.machine import machine
from conicoid_bench.service.encoding import COMPRESSIONS, Planes, copy_ms, decode, encode_ms
from conicoid_bench.service.server import Answer, Connection, ServiceFailed, serving

Results = dict[str, Any]

STARTS: Final = 3
LAPS: Final = 7
AGAIN: Final = 15
CLIENTS: Final = 2
_FIRST_ID: Final = 1_000_000
# The threads of the one before may wait for more work, busily.
_PAUSE_S: Final = 0.02


class Documents:
    """One scene in any number of documents, whose quadrics differ to the service: the first has another id in each."""

    def __init__(self, text: bytes) -> None:
        self._scene = json.loads(text)
        self._next = _FIRST_ID

    def next(self, compression: str) -> bytes:
        """One that the service has not seen."""
        self._next += 1
        first, *others = self._scene["quadrics"]
        output = {**self._scene.get("output", {}), "compression": compression}
        quadrics = [first | {"id": self._next}, *others]
        return json.dumps(self._scene | {"quadrics": quadrics, "output": output}, separators=(",", ":")).encode()


def run(text: bytes, device: str | None, say: Callable[[str], object]) -> Results:
    """Measure.

    Args:
        text: a scene document with one camera, without arrays.
        device: as CONICOID_DEVICE; None reads it.
        say: told what is measured.
    Returns:
        Plain values for JSON, times in milliseconds.
    Raises:
        ServiceFailed: the service does not start, or sends other pixels than the engine renders.
    """
    engine = Engine(device)
    scene = parse(text).resolve()
    planes = {name: plane.copy() for name, plane in engine.render(scene).planes.items()}
    documents = Documents(text)
    say("starts")
    _start(documents, device)  # fills the kernel cache
    starts = [_start(documents, device) for _ in range(STARTS)]
    results: Results = {
        **machine(engine),
        "start_ms": median(starts),
        "width": scene.camera.width,
        "height": scene.camera.height,
        "channels": list(scene.output.channels),
        "quadrics": len(scene.quadrics),
        "document_bytes": len(documents.next("zip")),
        "image_bytes": sum(plane.nbytes for plane in planes.values()),
        "copy_ms": median(copy_ms(planes) for _ in range(LAPS)),
        "laps": LAPS,
        "clients": CLIENTS,
    }
    with serving(device) as port, closing(Connection(port)) as connection:
        threads = connection.device()["threads"]
        OpenEXR.set_global_thread_count(threads)
        _check(connection.render(documents.next("none")), planes)
        say("compressions")
        results |= {"threads": threads, "compressions": _compressions(connection, documents, planes)}
        say("the same request again")
        results |= _again(connection, documents.next("zip"))
        say(f"{CLIENTS} clients")
        for compression, row in results["compressions"].items():
            row["frames_per_s"] = _throughput(port, documents, compression)
    return results


def _start(documents: Documents, device: str | None) -> float:
    """From the command to the whole of a first frame."""
    document = documents.next("zip")
    begin = time.perf_counter()
    with serving(device) as port, closing(Connection(port)) as connection:
        connection.render(document)
        return 1e3 * (time.perf_counter() - begin)


def _check(answer: Answer, planes: Planes) -> None:
    sent = decode(answer.body)
    compared = planes.keys() - {"id"}
    if sent.keys() != planes.keys() or not all(np.array_equal(sent[name], planes[name]) for name in compared):
        raise ServiceFailed("the service sends other pixels than the engine renders")


def _compressions(connection: Connection, documents: Documents, planes: Planes) -> Results:
    alone: dict[str, list[float]] = {name: [] for name in COMPRESSIONS}
    answers: dict[str, list[Answer]] = {name: [] for name in COMPRESSIONS}
    for lap in range(LAPS + 1):  # the first one warms
        for name in COMPRESSIONS:
            time.sleep(_PAUSE_S)
            alone_ms = encode_ms(planes, name)
            time.sleep(_PAUSE_S)
            answer = connection.render(documents.next(name))
            if lap:
                alone[name].append(alone_ms)
                answers[name].append(answer)
    return {name: dict(_row(answers[name], alone[name])) for name in COMPRESSIONS}


def _row(answers: list[Answer], alone: list[float]) -> Iterator[tuple[str, Any]]:
    yield "bytes", len(answers[0].body)
    yield "ms", median(answer.ms for answer in answers)
    yield "openexr_ms", median(alone)
    yield "rest_ms", median(answer.ms - ms for answer, ms in zip(answers, alone, strict=True))
    yield "stages_ms", {stage: median(answer.stages[stage] for answer in answers) for stage in answers[0].stages}


def _again(connection: Connection, document: bytes) -> Results:
    first = connection.render(document)
    cached, known = [], []
    for _ in range(AGAIN):
        time.sleep(_PAUSE_S)
        cached.append(connection.render(document))
        time.sleep(_PAUSE_S)
        known.append(connection.render(document, first.tag))
    if any(answer.body != first.body for answer in cached) or any(answer.status != 304 for answer in known):
        raise ServiceFailed("the same request was not answered with the same bytes, or 304")
    return {"cached_ms": median(answer.ms for answer in cached), "not_modified_ms": median(a.ms for a in known)}


def _throughput(port: int, documents: Documents, compression: str) -> float:
    """Frames per second of several clients, each of which asks for the next frame when it has the last one."""
    asked = [[documents.next(compression) for _ in range(LAPS)] for _ in range(CLIENTS)]

    def client(mine: list[bytes]) -> None:
        with closing(Connection(port)) as connection:
            for document in mine:
                connection.render(document)

    begin = time.perf_counter()
    with ThreadPoolExecutor(CLIENTS) as clients:
        list(clients.map(client, asked))
    return CLIENTS * LAPS / (time.perf_counter() - begin)
