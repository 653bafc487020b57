"""The arguments of `conicoid render` and `conicoid join`, and those that every command on a scene has."""

import argparse

from conicoid_client.command.numbers import band, frame

PRECISIONS = ("exact", "float64", "float32")


def add_scene(command: argparse.ArgumentParser) -> None:
    """The scene, see `scene.read_scene`."""
    command.add_argument("scene", metavar="SCENE.json")
    command.add_argument("--arrays", metavar="FILE.npz", help='the arrays that the scene names as "@name"')


def add_render(render: argparse.ArgumentParser, server: str) -> None:
    """What `render` takes; `server` says what `--server` is."""
    add_scene(render)
    render.add_argument("-o", "--output", required=True, metavar="OUT.exr")
    render.add_argument("--preview", metavar="OUT.png", help="also write a picture: depth beside normals")
    render.add_argument(
        "--band", type=band, metavar="I/N", help="band I (from 0) of N of its rows, for `conicoid join`"
    )
    _add_frame(render)
    render.add_argument("--server", metavar="URL", help=server)
    render.add_argument("-v", "--verbose", action="store_true", help="say what was written and how long it took")


def add_join(join: argparse.ArgumentParser) -> None:
    """What `join` takes."""
    add_scene(join)
    join.add_argument("bands", nargs="+", metavar="BAND.exr", help="from the top, as `render --band` writes them")
    join.add_argument("-o", "--output", required=True, metavar="OUT.exr")
    _add_frame(join)


def _add_frame(command: argparse.ArgumentParser) -> None:
    command.add_argument("--frame", type=frame, metavar="K", help="of a scene with `cameras`: which, from 0")
    command.add_argument("--precision", choices=PRECISIONS, help="in place of the scene's own")
    command.add_argument("--progress", choices=("openjd",), help="progress and failure as lines for such a scheduler")
