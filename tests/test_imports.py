"""Who may import whom: client -> nothing of ours, service and bench -> engine, and OpenCL only where kernels run."""

import ast
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.checkout import ROOT

SOURCES = {
    "conicoid": ROOT / "cl",
    "conicoid_service": ROOT / "service",
    "conicoid_client": ROOT / "clients",
    "conicoid_bench": ROOT / "bench",
}
ENGINE_THIRD_PARTY = {"numpy", "pyopencl", "flint", "orjson", "safetensors"}
DEVICE_SIDE = {
    f"conicoid.{name}"
    for name in ("bins", "cast", "device", "engine", "memory", "places", "probe", "program", "refine", "settle",
                 "setup")
}  # fmt: skip
RUN_BY_ALEMBIC = {"conicoid_service.jobs.migrations.env"}


@dataclass(frozen=True)
class Import:
    """One `import` in one of our modules: who, whom, and whether it runs when the module loads."""

    importer: str
    imported: str
    at_load: bool

    @property
    def package(self) -> str:
        return self.importer.split(".")[0]

    @property
    def target(self) -> str:
        return self.imported.split(".")[0]


def imports_under(node: ast.AST, importer: str, at_load: bool = True) -> Iterator[Import]:
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.Import):
            yield from (Import(importer, alias.name, at_load) for alias in child.names)
        elif isinstance(child, ast.ImportFrom):
            assert child.module
            assert child.level == 0, f"{importer}: relative imports hide the direction"
            yield Import(importer, child.module, at_load)
        else:
            later = isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef) or is_type_checking(child)
            yield from imports_under(child, importer, at_load and not later)


def is_type_checking(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"


def modules() -> dict[str, Path]:
    files = {path: root for package, root in SOURCES.items() for path in (root / package).rglob("*.py")}
    names = {path: ".".join(path.relative_to(root).with_suffix("").parts) for path, root in files.items()}
    return {name.removesuffix(".__init__"): path for path, name in names.items()}


MODULES = modules()
IMPORTS = [found for name, path in MODULES.items() for found in imports_under(ast.parse(path.read_bytes()), name)]


def breaches(*, package: str, targets: set[str], at_load_only: bool = False) -> list[Import]:
    return [i for i in IMPORTS if i.package == package and i.target in targets and (i.at_load or not at_load_only)]


def test_engine_imports_neither_service_nor_client() -> None:
    assert not breaches(package="conicoid", targets={"conicoid_service", "conicoid_client", "conicoid_bench"})


def test_engine_needs_only_its_five_libraries() -> None:
    allowed = ENGINE_THIRD_PARTY | {"conicoid"} | sys.stdlib_module_names
    assert not [i for i in IMPORTS if i.package == "conicoid" and i.target not in allowed]


def test_service_does_not_import_the_client() -> None:
    assert not breaches(package="conicoid_service", targets={"conicoid_client", "conicoid_bench"})


def test_benchmarks_import_the_engine_alone() -> None:
    assert not breaches(package="conicoid_bench", targets={"conicoid_service", "conicoid_client"})


def test_what_only_benchmarks_need_is_imported_inside_functions() -> None:
    """So that the command can say which extra is missing."""
    extra = {"matplotlib", "mitsuba", "drjit", "numba"}
    assert not breaches(package="conicoid_bench", targets=extra, at_load_only=True)
    assert not [i for i in IMPORTS if i.target in extra and i.package != "conicoid_bench"]


def test_client_imports_the_others_only_inside_functions() -> None:
    """So a farm's submitter needs neither; without a server the command loads the service when it comes to that."""
    assert not breaches(
        package="conicoid_client", targets={"conicoid", "conicoid_service", "conicoid_bench"}, at_load_only=True
    )


def test_only_the_device_side_imports_pyopencl() -> None:
    assert {i.importer for i in IMPORTS if i.target == "pyopencl" and i.package != "conicoid_bench"} <= DEVICE_SIDE


@pytest.mark.parametrize(
    ("module", "without"),
    [
        ("conicoid_service.server", ["fastapi", "starlette", "uvicorn", "numpy"]),
        ("conicoid_service.app", ["numpy", "OpenEXR"]),
        ("conicoid_client.command.connect", ["fastapi", "httpx", "numpy"]),
        ("conicoid_client.command.render", ["httpx", "numpy"]),
    ],
)
def test_what_starts_the_children_does_not_first_load_what_they_need_not_wait_for(
    module: str, without: list[str]
) -> None:
    load = "import importlib, sys; importlib.import_module(sys.argv[1]); print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", load, module], check=True, capture_output=True, text=True).stdout
    assert not {*loaded.split()} & {*without}


@pytest.mark.parametrize("package", sorted(SOURCES.keys() - {"conicoid_bench"}))
def test_all_but_the_device_side_loads_without_an_opencl_driver(package: str) -> None:
    """So the API's process never holds a driver, and scenes and algebra work where there is none."""
    names = [n for n in MODULES if n.split(".")[0] == package and n not in DEVICE_SIDE | RUN_BY_ALEMBIC]
    load = "import importlib, sys; sys.modules['pyopencl'] = None; [importlib.import_module(n) for n in sys.argv[1:]]"
    subprocess.run([sys.executable, "-W", "error", "-c", load, *names], check=True)
