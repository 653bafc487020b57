"""`conicoid join`: the bands of a frame in, the file that the frame has in one piece out. No OpenCL, no service."""

import argparse
import io
from contextlib import ExitStack
from pathlib import Path

from conicoid_client import files
from conicoid_client.command import openjd
from conicoid_client.command.connect import settings
from conicoid_client.command.progress import progress
from conicoid_client.command.report import Failure, UsageError
from conicoid_client.command.scene import read_scene
from conicoid_client.errors import Problem, SceneRejected
from conicoid_client.precision import with_precision


def run(options: argparse.Namespace) -> None:
    """Read, join, write."""
    with openjd.lines(options, f"joining {options.output}"), progress(f"joining {options.output}"):
        _join(options)


def _join(options: argparse.Namespace) -> None:
    """The scene says what the bands cannot: what the frame's file is to be like, and which bands are its own."""
    files.check_writable(options.output)
    text, npz = read_scene(options)
    if options.precision is not None:
        text = with_precision(text, options.precision)

    from conicoid.canonical import quadrics_hash
    from conicoid.document import read_npz
    from conicoid.errors import ConicoidError, SceneError
    from conicoid_client import exr as client_exr
    from conicoid_service import exr, joining
    from conicoid_service.cpus import usable_cpus
    from conicoid_service.errors import ParameterError
    from conicoid_service.parts import Part, read_document, view_of

    configuration, part, image = settings(), Part(options.frame), io.BytesIO()
    exr.set_threads(configuration.threads or usable_cpus())
    with ExitStack() as stack:
        bands = [stack.enter_context(Path(name).open("rb")) for name in options.bands]
        try:
            arrays = {} if npz is None else read_npz(io.BytesIO(npz), configuration.body_limit)
            document = read_document(text, arrays, part)
            camera, output = view_of(document, part)
            quadrics = document.scene or quadrics_hash(document.resolve_quadrics())
            with client_exr.muted():
                joining.join(image, camera, output, bands, quadrics)
        except SceneError as error:
            problems = [Problem(one.pointer, one.message, one.code) for one in error.problems]
            raise SceneRejected(422, error.code, str(error), problems) from None
        except ParameterError as error:
            raise UsageError(f"{error} [{error.code}]") from None
        except ConicoidError as error:
            raise Failure(f"{error} [{error.code}]") from None
    files.write(options.output, image.getbuffer())
