"""Scenes where planes tie with something at every pixel (tests/scenes/floods.py): pixels left to the host, and times.

    python bench/floods.py [--device "PoCL 3.1"] [--size 1920 1080]

Prints a row of docs/exactness.md for each: the second of two renderings.
"""

import argparse

from conicoid.engine import Renderer
from tests.scenes import as_scene
from tests.scenes.floods import FLOODS, flood


def main() -> None:
    """The command line above."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", default="", help="as CONICOID_DEVICE")
    parser.add_argument("--size", type=int, nargs=2, default=(1920, 1080))
    arguments = parser.parse_args()
    renderer = Renderer(arguments.device or None)
    for name in FLOODS:
        scene = as_scene(flood(name, tuple(arguments.size)))
        frame = [renderer.render(scene) for _ in range(2)][-1]
        print(f"| {name} | {frame.settled:,} | {frame.setup_ms + frame.cast_ms:.0f} |", flush=True)


if __name__ == "__main__":
    main()
