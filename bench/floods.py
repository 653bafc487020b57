"""Scenes where planes tie with something at every pixel (tests/scenes/floods.py): pixels left to the host, and times.

    python -m bench.floods [--device "PoCL 3.1"] [--size 1920 1080] [--repeats 2]

Prints rows of docs/exactness.md: pixels and milliseconds of the last rendering, by a pinhole / by parallel rays.
"""

import argparse

from conicoid.engine import Frame, Renderer
from tests.scenes import as_scene
from tests.scenes.floods import FLOODS, flood


def main() -> None:
    """The command line above."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", default="", help="as CONICOID_DEVICE")
    parser.add_argument("--size", type=int, nargs=2, default=(1920, 1080))
    parser.add_argument("--repeats", type=int, default=2)
    arguments = parser.parse_args()
    renderer = Renderer(arguments.device or None)
    rows: dict[str, list[Frame]] = {}
    for name in FLOODS:
        scene = as_scene(flood(name, tuple(arguments.size)))
        frames = [renderer.render(scene) for _ in range(arguments.repeats)]
        rows.setdefault(name.removesuffix(", pinhole").removesuffix(", orthographic"), []).append(frames[-1])
    for name, views in rows.items():
        settled = " / ".join(f"{frame.settled:,}" for frame in views)
        times = " / ".join(f"{frame.setup_ms + frame.cast_ms:.0f}" for frame in views)
        print(f"| {name} | {settled} | {times} |")


if __name__ == "__main__":
    main()
