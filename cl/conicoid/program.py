"""Building kernels: sources from the package, errors that name the real file and line."""

import importlib.resources
import re
import warnings
from collections.abc import Mapping, Sequence
from typing import Final

import pyopencl

from conicoid.errors import KernelError

_CORRECT_DIVIDE: Final = pyopencl.device_fp_config.CORRECTLY_ROUNDED_DIVIDE_SQRT


def build(
    context: "pyopencl.Context", files: Sequence[str], defines: Mapping[str, int] | None = None
) -> "pyopencl.Program":
    """Compile kernel files, in order, as one program.

    Args:
        context: holds one device.
        files: names in `conicoid/kernels`; later ones see what earlier ones define.
        defines: values of the few `-D` names that the files ask for.
    Raises:
        KernelError: with the compiler's log, lines counted in the named files.
    """
    folder = importlib.resources.files("conicoid") / "kernels"
    # Neither contraction, but where a file asks for it, nor anything of -cl-fast-relaxed-math: double-double needs
    # every operation as written.
    parts = ["#pragma OPENCL EXTENSION cl_khr_fp64 : enable\n#pragma OPENCL FP_CONTRACT OFF\n"]
    parts += [f'#line 1 "{name}"\n{(folder / name).read_text(encoding="utf-8")}\n' for name in files]
    options = [f"-D{name}={value}" for name, value in (defines or {}).items()]
    if all(device.single_fp_config & _CORRECT_DIVIDE for device in context.devices):
        # binary32 / and sqrt start the normals' Newton step: with it, every device's result is the same.
        options.append("-cl-fp32-correctly-rounded-divide-sqrt")
    try:
        with warnings.catch_warnings():
            # PoCL writes remarks to the build log of programs that build.
            warnings.simplefilter("ignore", pyopencl.CompilerWarning)
            program: pyopencl.Program = pyopencl.Program(context, "".join(parts)).build(options)
            return program
    except pyopencl.RuntimeError as error:
        log = re.sub(r"\x1b\[[0-9;]*m", "", str(error))
        asked = f"{', '.join(files)} with {' '.join(options) or 'no options'}"
        raise KernelError(f"the compiler refused {asked}:\n{log}") from None
