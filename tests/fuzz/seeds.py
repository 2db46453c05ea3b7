"""Good inputs to spoil: the scenes, an example of every class, and some texts of their own."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

#: A config that has every section; `base.cfg` of the working directory.
BASE = """\
job
{
    t = 0
    dt = 1e-3
    TYPE = 2
    threads = 1
}
serializer
{
    class = "DefaultVTK"
    properties = {100}
    str-properties = {"frames", "save", "test"}
}
driver
{
    class = "DefaultDriver"
    properties = {0.01}
}
solver
{
    class = "ExplicitUSL"
    int-properties = {1, 1}
}
grid
{
    class = "CartesianLinear"
    properties = {1.0, 1.0}
    int-properties = {10, 10}
}
body
{
    class = "DefaultBody"
    name = "block_0"
    point-file = "2.points"
    point-class = "DefaultPoints"
    node-class = "DefaultNodes"
    material-class = "IsotropicLinearElasticity"
    material-props = {E = 1e5, nu = 0.3}
    boundary-class = "CartesianBox"
}
body
{
    class = "DefaultBody"
    name = "block_1"
    point-file = "block.parts"
    point-class = "CartesianPoints"
    node-class = "DefaultNodes"
    material-class = "IsotropicLinearElasticity"
    material-props = {1e6, 0.2}
    boundary-class = "CartesianSmoothBox"
}
contact
{
    class = "ContactHuang"
    name = "touch"
    properties = {0.4}
    str-properties = {"block_0", "block_1"}
}
"""
PARTS = """\
Lx = {1.0, 1.0}     # lengths of the lattice
Nx = {10, 10}
lmpp = 2
rho = 1000
part { class = "Box" properties = {0.2, 0.2, 0.4, 0.4} }
part
{
    class = "Ball"
    properties = {centre_x = 0.7, centre_y = 0.6, radius = 0.2}
}
part { class = "SandPile" properties = {0.5, 0.4, 0.6} }
part { class = "SineWave" properties = {0.05, 1.0, 0.0, 0.5} }
"""
OVERRIDES = """\
job.dt=2e-4
grid.int-properties={20, 20}
body.block_0.material-props={E = 1e7, nu = 0.4}
contact.0.properties=0
serializer.properties={60, save_wall = 1800}
body.1.point-file=2.points
"""
#: Components of positions and velocities in points files by TYPE.
COMPONENTS = {1: 1, 2: 2, 3: 3, 4: 3, 5: 3}
DIM = {1: 1, 2: 2, 3: 3, 4: 2, 5: 2}


@dataclass
class Seeds:
    """Texts to start from, by the ending that says what they are, and words to put into them."""

    texts: dict[str, list[str]] = field(default_factory=dict)
    words: list[str] = field(default_factory=list)


def points(sim_type: int, n: int = 3) -> str:
    """Return a small points table."""
    dim, rows = DIM[sim_type], []
    for k in range(n**dim):
        index = [k // n**d % n for d in range(dim)]
        x = [0.2 + 0.1 * i for i in index] + [0.0] * (COMPONENTS[sim_type] - dim)
        v = [0.5, -0.25, 0.0][: COMPONENTS[sim_type]]
        rows.append(" ".join(map(repr, [1000 * 0.1**dim, 0.1**dim, *x, *v])) + " 1")
    return f"{len(rows)}\n" + "\n".join(rows) + "\n"


def working_files() -> dict[str, str]:
    """Return the files that inputs may name: a base config, a text and tables of every TYPE."""
    return {
        "base.cfg": BASE,
        "block.parts": PARTS.partition('part { class = "SandPile"')[0],
        **{f"{sim_type}.points": points(sim_type) for sim_type in COMPONENTS},
    }


def with_small_points(config: str) -> str:
    """Name the small tables in place of those of a scene."""
    found = re.search(r"TYPE = (\d)", config)
    table = f'"{found[1] if found else 3}.points"'
    config = re.sub(r'point-file = "[^"]*points"', f"point-file = {table}", config)
    config = re.sub(r'point-file = "[^"]*parts"', 'point-file = "block.parts"', config)
    return config.replace('"projectile"', '"block_1"') if "block_1" in config else config


def put_into_base(role: str, example: str) -> str:
    """Put the example of a class into the base config in place of the object of its role."""
    section = re.match(r"\s*(\w+)\s*\{", example)
    if section and section[1] in BASE:
        pattern = rf"^{section[1]}\n\{{\n.*?^\}}\n"
        return with_small_points(
            re.sub(pattern, lambda _: example + "\n", BASE, count=1, flags=re.DOTALL | re.MULTILINE)
        )
    stem = {"boundaries": "boundary"}.get(role, role.rstrip("s"))
    head, name, rest = BASE.partition('    name = "block_0"\n')
    first, end, rest = rest.partition("}\nbody")
    lines = [line for line in first.splitlines() if not line.strip().startswith(f"{stem}-")]
    return with_small_points(f"{head}{name}{example}" + "\n".join(lines) + f"\n{end}{rest}")


def collect() -> Seeds:
    """Return all seeds: none of them is made by chance."""
    scenes = sorted(ROOT.glob("configs/*/*.cfg"))
    configs = [BASE, *(with_small_points(path.read_text()) for path in scenes)]
    words = {"part", "class", "properties", "Lx", "Nx", "lmpp", "rho", "out_file"}
    for page in sorted(ROOT.glob("docs/reference/*/*.md")):
        text = page.read_text()
        words.update(re.findall(r"^# (\w+)$", text, re.MULTILINE))
        words.update(re.findall(r"^\| `(\w+)` \|", text, re.MULTILINE))
        example = re.search(r"^```cfg\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
        if example and page.parent.name != "parts":
            block = example[1].partition("# block.parts\n")[0].replace("# in the config\n", "")
            configs.append(put_into_base(page.parent.name, block))
    words.update(re.findall(r"[\w-]+(?= =)", "\n".join(configs)))
    generated = [p.read_text() for p in sorted(ROOT.glob("configs/*/*.parts"))]
    one = re.sub(r"part \{ class = \"SineWave.*", "", PARTS)
    seeds = Seeds(words=sorted(words))
    seeds.texts["cfg"] = configs
    seeds.texts["set"] = [OVERRIDES]
    for sim_type, dim in DIM.items():
        seeds.texts[f"{sim_type}.points"] = [points(sim_type, 2), points(sim_type)]
        seeds.texts[f"{sim_type}.parts"] = (
            [PARTS, *generated] if dim == 2 else [one.replace("1.0, 1.0", ", ".join(["1.0"] * dim))]
        )
    return seeds
