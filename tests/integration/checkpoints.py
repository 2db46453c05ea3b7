"""A scene that any class can be part of, for the tests of checkpoints.

Two bodies that collide and a third one, under gravity, in TYPE 2 where the class has it. A class
takes its place in it by the example that it gives of itself.
"""

from __future__ import annotations

import re
import shutil
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
from meshes import CELLS, MESH, TRIANGLES, needs_mesh, type_of, write_mesh
from scene import DIM, MATERIALS, Run, block, huang, write_points

DT = 1e-3
STEPS = 60
#: Steps between two frames.
FRAME = 10
#: Step of the checkpoint: one without a frame, after several with contact.
SAVED = 34
T_START = -0.02
T_STOP = T_START + STEPS * DT
RATE = 1.0 / (FRAME * DT)
NAME = "test"

SECTIONS = {
    "serializer": """serializer
{
    class = "DefaultVTK"
    properties = {60}
    str-properties = {"output", "save", "test"}
}""",
    "driver": 'driver { class = "DefaultDriver" properties = {1} }',
    "solver": 'solver { class = "ExplicitUSL" }',
    "grid": """grid
{
    class = "CartesianLinear"
    properties = {1, 1}
    int-properties = {20, 20}
}""",
    "contact": huang("block_0", "block_1"),
}
PARTS = {
    "points": '    point-class = "DefaultPoints"\n    point-file = "NAME.points"',
    "nodes": '    node-class = "DefaultNodes"',
    "material": '    material-class = "IsotropicLinearElasticity"\n    material-props = {1e5, 0.3}',
    "boundary": '    boundary-class = "CartesianBox"',
}
#: The boundary of a body that others meet as a rigid one.
ASSIGNED = '    boundary-class = "AssignedVelocity"\n    boundary-props = {0.5, 0}'
LATTICE = "Lx = {1, 1}\nNx = {20, 20}\nlmpp = 2\nrho = 1000\n"
BODIES = {
    # Enough points that two threads share the work.
    "block_0": ([0.2, 0.2], [0.4, 0.4], [68, 64], [0.5, -0.4]),
    "block_1": ([0.42, 0.22], [0.6, 0.4], [12, 12], [-0.5, -0.4]),
    "projectile": ([0.3, 0.7], [0.4, 0.8], [6, 6], [0.1, 0.2]),
}
#: The material of bodies that drivers of fish ask for, and a file that one of them reads: the mean
#: and no variance but in the first and the last number.
FISH = """    material-class = "Fish"
    material-props = {1e4, 0.3, 0, 0, 0, 0, 0, 0, 0, 0, 0}"""
VARIANCE = np.diag([1e-4, 0, 0, 0, 0, 0, 0, 0, 0.1]).ravel().tolist()
MIXTURE = "1, 9\n\n" + ", ".join(map(repr, [1.0, *[0.02] * 3, *[6.0] * 3, 0, 0, 0, *VARIANCE]))
#: Height of the bodies in 3D, and the points across it.
HEIGHT, LAYERS = 0.1, 3
#: What examples of materials are given so that waves are slow enough for the time step.
SOFTER = {
    "Cornstarch": [("E = 1e6", "E = 1e5")],
    "TillotsonEOSFluid": [("A = 2.18e9", "A = 2e5"), ("B = 1.325e10", "B = 2e5")],
    "Fish": [("E = 1e5", "E = 1e4")],
    "BreakageMechanicsSand": [
        ("p_r = 1e3, K = 12000, G = 9000", "p_r = 10, K = 1200, G = 900"),
        ("E_c = 3.5e4", "E_c = 1500"),
        # The crash is more than grains this soft can bear: they begin loose.
        ("phi_0 = 0.4", "phi_0 = 0.6"),
    ],
}


@dataclass
class Class:
    """A registered class."""

    role: str
    name: str
    #: Lines of a config, with all that the class shows of itself.
    example: str


def registered(run: Run, folder: Path) -> list[Class]:
    """Return all classes of the program but shapes, which are gone when a run begins."""
    listed = run("--list", cwd=folder)
    assert listed.returncode == 0
    found, role = [], ""
    for line in listed.stdout.splitlines():
        if not line.startswith(" "):
            role = line.strip()
        elif role != "part" and (match := re.match(r"  (\w+) +(?!not available)\w", line)):
            name = match[1]
            described = run("--describe", name, cwd=folder)
            assert described.returncode == 0
            example = described.stdout.partition("\nexample\n")[2]
            for stiff, soft in SOFTER.get(name, []):
                assert stiff in example
                example = example.replace(stiff, soft)
            found.append(Class(role, name, example))
    return found


def set_first(section: str, values: str) -> str:
    """Replace the first of the properties of a section."""
    changed, n = re.subn(r"(\n *properties = \{) *[^,}]*", rf"\g<1>{values}", section, count=1)
    if n == 0:
        changed, n = re.subn(r"( properties = \{) *[^,}]*", rf"\g<1>{values}", section, count=1)
    assert n == 1, section
    return changed


def write_scene(folder: Path, role: str = "", example: str = "", **saving: float) -> None:
    """Write a config with an example in its place, and the points files."""
    sections, parts, first = dict(SECTIONS), dict(PARTS), ""
    sim_type = type_of(example)
    dim = DIM[sim_type]
    write_mesh(folder / MESH, max(2, dim), CELLS[sim_type])
    if needs_mesh(example):
        sections["grid"] = TRIANGLES
    if role in sections:
        sections[role] = example
        if role == "driver" and "Fish" in example:
            parts["material"] = FISH
            (folder / "mixture.txt").write_text(MIXTURE)
    elif role in parts:
        parts[role], _, text = example.partition("# block.parts\n")
        box = 'part { class = "Box" properties = {0.2, 0.2, 0.4, 0.4} }\n'
        (folder / "block.parts").write_text(text or LATTICE + box)
    elif role == "body":
        first = example
    else:
        assert role in ("", "probe")
    named = "".join(f", {key} = {value!r}" for key, value in saving.items())
    if role == "probe":
        named += f", history_rate = {0.5 * RATE!r}"
    serializer, n = re.subn(
        r"(\n *properties = \{[^}]*)\}", rf"\g<1>{named}}}", sections["serializer"], count=1
    )
    assert n == 1
    sections["serializer"] = set_first(serializer, repr(RATE))
    sections["driver"] = set_first(sections["driver"], repr(T_STOP))
    bodies = []
    for name, (lower, upper, counts, velocity) in BODIES.items():
        # What takes the place of points is for the first body only.
        chosen = {**parts, "points": parts["points"] if name == "block_0" else PARTS["points"]}
        if name == "block_0" and "ContactRigid" in example:
            chosen["boundary"] = ASSIGNED
        for class_name, materials in MATERIALS.items():
            if f'"{class_name}"' in example:
                chosen["material"] = materials.get(name, chosen["material"])
                sections["contact"] = ""
        text = "\n".join(chosen.values()).replace("NAME", name)
        bodies.append(f'body\n{{\n    class = "DefaultBody"\n    name = "{name}"\n{text}\n}}')
        if dim == 3:
            # As many points as before would take long.
            counts = [min(n, 12) for n in counts] + [LAYERS]
            lower, upper, velocity = [*lower, 0.4], [*upper, 0.4 + HEIGHT], [*velocity, 0.0]
        rows = block(sim_type, lower[:dim], upper[:dim], counts[:dim], velocity=velocity[:dim])
        write_points(folder / f"{name}.points", rows)
    shutil.copy(folder / "block_0.points", folder / "block.points")
    if first:
        bodies[0] = first
    contact = sections.pop("contact")
    job = f"job {{ t = {T_START!r} dt = {DT!r} TYPE = {sim_type} }}"
    probe = example if role == "probe" else ""
    config = "\n".join([job, *sections.values(), *bodies, contact, probe]) + "\n"
    (folder / "scene.cfg").write_text(config)


def checkpoint(step: int, folder: str = "save", name: str = NAME) -> str:
    """Return the path of a checkpoint."""
    return f"{folder}/{name}.{step:012d}.h5"


def contents(path: Path) -> dict[str, bytes]:
    """Return all datasets and attributes of a file."""
    found: dict[str, bytes] = {}

    def visit(name: str, item: h5py.Group | h5py.Dataset) -> None:
        if isinstance(item, h5py.Dataset):
            found[name] = np.asarray(item[()]).tobytes()
        found.update({f"{name}@{key}": repr(value).encode() for key, value in item.attrs.items()})

    with h5py.File(path) as file:
        file.visititems(visit)
    return found


def files_of(folder: Path) -> dict[str, bytes]:
    """Return the content of all files of a folder by their names.

    Of an HDF5 file these are its values: where they stand in it depends on how it grew.
    """
    return {
        path.name: repr(contents(path)).encode() if path.suffix == ".vtkhdf" else path.read_bytes()
        for path in sorted(folder.iterdir())
        if path.is_file()
    }


def frames_of(folder: Path) -> dict[str, bytes]:
    """Return what `files_of` does, without the file that tells config and options of the run."""
    found = files_of(folder)
    return {name: data for name, data in found.items() if not name.endswith(".run.txt")}
