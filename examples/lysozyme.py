"""Write lysozyme.json: the atoms and bonds of lysozyme.pdb as spheres and cylinders, in angstroms.

python examples/lysozyme.py
"""

import json
import math
from collections import defaultdict
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

HERE = Path(__file__).parent

# Van der Waals radii, angstroms: Bondi, J. Phys. Chem. 68 (1964) 441.
VAN_DER_WAALS = {"H": 1.2, "C": 1.7, "N": 1.55, "O": 1.52, "S": 1.8}
ATOM_SCALE = 0.35
BOND_RADIUS = 0.12

# No bond of a protein is longer, and no two unbonded atoms here are closer: 1.9 between heavy atoms, 1.3 with hydrogen.
LONGEST_BOND = 1.9
LONGEST_HYDROGEN_BOND = 1.3

Point = tuple[float, float, float]


class Atom(NamedTuple):
    """One atom: element symbol and position in angstroms."""

    element: str
    position: Point


def read_atoms(pdb: str) -> list[Atom]:
    """The ATOM records of a PDB file; the element is the first letter of the atom's name."""
    records = [line for line in pdb.splitlines() if line.startswith("ATOM")]
    return [
        Atom(line[12:16].strip(" 0123456789")[0], (float(line[30:38]), float(line[38:46]), float(line[46:54])))
        for line in records
    ]


def find_bonds(atoms: list[Atom]) -> list[tuple[int, int]]:
    """Pairs of atoms that are close enough to be bonded, in order; only neighbouring cells of a grid are compared."""
    cells: dict[tuple[int, ...], list[int]] = defaultdict(list)
    for k, atom in enumerate(atoms):
        cells[_cell(atom.position)].append(k)
    pairs = (
        (i, j)
        for i, atom in enumerate(atoms)
        for offset in product((-1, 0, 1), repeat=3)
        for j in cells.get(tuple(c + o for c, o in zip(_cell(atom.position), offset, strict=True)), ())
        if i < j
    )
    return sorted((i, j) for i, j in pairs if _bonded(atoms[i], atoms[j]))


def _cell(position: Point) -> tuple[int, ...]:
    return tuple(math.floor(x / LONGEST_BOND) for x in position)


def _bonded(a: Atom, b: Atom) -> bool:
    longest = LONGEST_HYDROGEN_BOND if "H" in (a.element, b.element) else LONGEST_BOND
    return math.dist(a.position, b.position) <= longest


def sphere(atom: Atom) -> dict[str, Any]:
    """An atom, a third of its van der Waals size."""
    return {"shape": "sphere", "center": atom.position, "radius": round(ATOM_SCALE * VAN_DER_WAALS[atom.element], 6)}


def cylinder(a: Atom, b: Atom) -> dict[str, Any]:
    """A bond: a cylinder about its own z axis, turned from z to the direction from a to b."""
    (ax, ay, az), (bx, by, bz) = a.position, b.position
    length = math.dist(a.position, b.position)
    dx, dy, dz = (bx - ax) / length, (by - ay) / length, (bz - az) / length
    # The shortest turn from z to d is about z x d; its quaternion is (z x d, 1 + z.d), normalised.
    x, y, w = -dy, dx, 1 + dz
    norm = math.sqrt(x * x + y * y + w * w)
    return {
        "shape": "cylinder",
        "radius": BOND_RADIUS,
        "center": [(ax + bx) / 2, (ay + by) / 2, (az + bz) / 2],
        "rotation": [x / norm, y / norm, 0.0, w / norm],
        "z_range": [-length / 2, length / 2],
    }


def scene(atoms: list[Atom]) -> dict[str, Any]:
    """All atoms, then all bonds, seen from the upper right."""
    x, y, z = (sum(atom.position[k] for atom in atoms) / len(atoms) for k in range(3))
    return {
        "conicoid": 1,
        "quadrics": [sphere(atom) for atom in atoms] + [cylinder(atoms[i], atoms[j]) for i, j in find_bonds(atoms)],
        "camera": {
            "projection": "pinhole",
            "width": 1920,
            "height": 1080,
            "fov_y": 40.0,
            "look_at": {"eye": [x + 30, y + 15, z + 55], "target": [x, y, z], "up": [0, 1, 0]},
        },
        "output": {"channels": ["Z", "N"]},
    }


if __name__ == "__main__":
    document = scene(read_atoms((HERE / "lysozyme.pdb").read_text()))
    (HERE / "lysozyme.json").write_text(json.dumps(document))
