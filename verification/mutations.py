"""Break the program on purpose, one defect at a time, and see which cases notice.

    scripts/verify --mutations [NAME ...]

Each mutation edits a copy of the sources, builds the program and runs the quick tier. A mutation
that no row of the matrix catches shows a gap of the verification; the exit status tells of any.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


@dataclass(frozen=True)
class Mutation:
    """A defect: texts to be replaced in a source file, or in several."""

    name: str
    what: str
    file: str
    #: Old and new texts; each old text must be there exactly once.
    edits: tuple[tuple[str, str], ...]
    #: Other files with the same edits.
    others: tuple[str, ...] = ()

    @property
    def files(self) -> tuple[str, ...]:
        """All files with the defect."""
        return (self.file, *self.others)


MUTATIONS = (
    Mutation(
        "gradient-sign",
        "one sign in the gradient of the linear functions (P2G in 1D and 2D)",
        "src/kernels/p2g_hat_template.inc",
        (
            (
                "fx = (-volume(p)*inverse_h(1))*slope_x(l)",
                "fx = (-volume(p)*inverse_h(1))*abs(slope_x(l))",
            ),
            (
                "fy = ((-volume(p)*inverse_h(1))*slope_x(l))*fy",
                "fy = ((-volume(p)*inverse_h(1))*abs(slope_x(l)))*fy",
            ),
        ),
    ),
    Mutation(
        "gradients-reversed",
        "all gradients of the linear functions have the wrong sign (cancels in the motion)",
        "src/kernels/p2g_hat_template.inc",
        (("inverse_h = 1.0_wp/stencil%h(:DIM)", "inverse_h = -1.0_wp/stencil%h(:DIM)"),),
        others=("src/kernels/g2p_hat_template.inc",),
    ),
    Mutation(
        "averaged-gradient",
        "the averaged functions' gradient is that of boxes twice as wide",
        "src/kernels/weights_template.inc",
        (("slope = 1.0_wp/extent(p)", "slope = 0.5_wp/extent(p)"),),
    ),
    Mutation(
        "shear-modulus-twice",
        "factor 2 in the shear modulus of plane strain",
        "src/materials/isotropic_linear_elasticity.f90",
        (
            (
                "0.5_wp*dt_2g*(gradient(2, p) + gradient(3, p))",
                "dt_2g*(gradient(2, p) + gradient(3, p))",
            ),
        ),
    ),
    Mutation(
        "spin-sign",
        "the Jaumann rate turns the stress the wrong way in plane strain",
        "src/materials/isotropic_linear_elasticity.f90",
        (
            (
                "0.5_wp*dt*(gradient(2, p) - gradient(3, p))",
                "0.5_wp*dt*(gradient(3, p) - gradient(2, p))",
            ),
        ),
    ),
    Mutation(
        "spin-missing",
        "no Jaumann terms in the TYPEs with six stress components",
        "src/materials/isotropic_linear_elasticity.f90",
        (
            ("wxy = 0.5_wp*dt*(l(2) - l(4))", "wxy = 0.0_wp"),
            ("wyz = 0.5_wp*dt*(l(6) - l(8))", "wyz = 0.0_wp"),
            ("wzx = 0.5_wp*dt*(l(7) - l(3))", "wzx = 0.0_wp"),
        ),
    ),
    Mutation(
        "lateral-stress",
        "plane strain without the stress across the plane",
        "src/materials/isotropic_linear_elasticity.f90",
        (("stress(3, p) = stress(3, p) + sphere\n", "stress(3, p) = 0.0_wp*stress(3, p)\n"),),
    ),
    Mutation(
        "old-velocity-strain",
        "strain rate from the velocity before the grid update",
        "src/solvers/explicit_steps.f90",
        (
            (
                "    real(wp) :: velocity(3*block_size), increment(3*block_size), "
                "gradient(9*block_size)\n",
                "    real(wp) :: velocity(3*block_size), increment(3*block_size), "
                "gradient(9*block_size)\n"
                "    real(wp) :: unused_v(3*block_size), unused_i(3*block_size)\n",
            ),
            (
                "                                nodes%increment, velocity, increment, gradient)\n",
                "                                nodes%increment, velocity, increment, gradient)\n"
                "        call interpolate_points(points, stencil, nodes%window, a, b, &\n"
                "                                nodes%velocity - nodes%increment, &\n"
                "                                nodes%increment, unused_v, unused_i, gradient)\n",
            ),
        ),
    ),
    Mutation(
        "pic",
        "points take the velocity of the grid (PIC) instead of adding its increment (FLIP)",
        "src/kernels/advance.f90",
        (
            (
                "    call add_scaled(kin%nvel*n, 1.0_wp, increment, velocity)\n",
                "    velocity = grid_velocity + 0.0_wp*increment\n",
            ),
        ),
    ),
    Mutation(
        "position-old-velocity",
        "points move with their own velocity instead of the grid's",
        "src/kernels/advance.f90",
        (
            (
                "      call add_scaled(kin%nvel*n, dt, grid_velocity, x)\n",
                "      call add_scaled(kin%nvel*n, dt, velocity, x)\n",
            ),
        ),
    ),
    Mutation(
        "volume-frozen",
        "volumes do not change with the deformation",
        "src/kernels/advance.f90",
        (
            (
                "      volume(p) = volume(p)*stretch(p)\n",
                "      volume(p) = volume(p)*stretch(p)**0\n",
            ),
        ),
    ),
    Mutation(
        "hoop-stress",
        "no hoop stress in the nodal forces of TYPE 4",
        "src/kernels/p2g_hat_template.inc",
        (("hoop(1) = -volume(p)*stress(3, p)/r", "hoop(1) = -0.0_wp*stress(3, p)/r"),),
    ),
    Mutation(
        "swirl-inertia",
        "TYPE 4 without the inertia of the rotating basis",
        "src/kernels/advance.f90",
        (
            ("        angle = dt*v_t/r\n", "        angle = 0.0_wp*r\n"),
            ("v_t*min(r/r_new, largest_growth)", "v_t + 0.0_wp*min(r_new, largest_growth)"),
        ),
    ),
    Mutation(
        "body-force-twice",
        "gravity counts twice",
        "src/kernels/node_update.f90",
        (("+ body_force(i)*merge(", "+ 2.0_wp*body_force(i)*merge("),),
    ),
    Mutation(
        "frictionless",
        "contact without friction",
        "src/contacts/contact_law.f90",
        (("rub(nvel, friction*abs(pull), ", "rub(nvel, 0.0_wp*friction, "),),
    ),
    Mutation(
        "adhesion",
        "contact also holds bodies together that separate",
        "src/contacts/contact_law.f90",
        (
            (
                "      if (.not. pull < 0.0_wp) return\n",
                "      if (.not. abs(pull) > 0.0_wp) return\n",
            ),
        ),
    ),
    Mutation(
        "contact-one-sided",
        "the second body does not feel the contact",
        "src/contacts/contact_law.f90",
        (("    f2 = f2 - force\n", "    f2 = f2 - 0.0_wp*force\n"),),
    ),
    Mutation(
        "contact-half",
        "half of the contact force",
        "src/contacts/contact_law.f90",
        (("/(share*dt)", "/(share*dt*2.0_wp)"),),
    ),
    Mutation(
        "wall-rough",
        "smooth walls hold the second component too",
        "src/boundaries/cartesian_smooth_box.f90",
        (
            (
                "      call self%faces%fix(face, axis, axis, nodes)\n",
                "      call self%faces%fix(face, min(axis, 2), &\n"
                "                          max(axis, min(2, nodes%kin%nvel)), nodes)\n",
            ),
        ),
    ),
)


def main() -> int:
    """Try the mutations; return 1 when one of them escapes."""
    parser = argparse.ArgumentParser(prog="scripts/verify --mutations", description=__doc__)
    parser.add_argument("names", nargs="*", help="mutations; all when left out")
    parser.add_argument("--list", action="store_true", help="list the mutations")
    parser.add_argument("--all-rows", action="store_true", help="run every row, not to the first")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    arguments = parser.parse_args()
    known = {mutation.name: mutation for mutation in MUTATIONS}
    if arguments.list:
        for mutation in MUTATIONS:
            print(f"{mutation.name}: {mutation.what}")
        return 0
    if unknown := sorted(set(arguments.names) - set(known)):
        sys.exit(f"scripts/verify: no such mutation: {', '.join(unknown)}")
    escaped = []
    with tempfile.TemporaryDirectory(prefix="mpm3d-mutations-") as name:
        workshop = Workshop(Path(name), arguments.jobs)
        for mutation in (known[n] for n in arguments.names or known):
            caught = workshop.try_one(mutation, all_rows=arguments.all_rows)
            print(f"{mutation.name}: {mutation.what}")
            print("\n".join(f"    {line}" for line in caught) or "    ESCAPED", flush=True)
            if not caught:
                escaped.append(mutation.name)
    if escaped:
        print(f"escaped: {', '.join(escaped)}")
    return 1 if escaped else 0


class Workshop:
    """A copy of the sources with a build of its own."""

    def __init__(self, folder: Path, jobs: int) -> None:
        self.tree, self.build, self.jobs = folder / "tree", folder / "build", jobs
        shutil.copytree(ROOT, self.tree, ignore=shutil.ignore_patterns(".git", "build", "results"))
        configure = ["cmake", "-S", self.tree, "-B", self.build, "-G", "Ninja"]
        run([*configure, "-DCMAKE_BUILD_TYPE=Release"])

    def try_one(self, mutation: Mutation, *, all_rows: bool) -> list[str]:
        """Apply a mutation, build, run the quick tier; return the failed rows."""
        originals = {self.tree / file: (self.tree / file).read_text() for file in mutation.files}
        for path, original in originals.items():
            text = original
            for old, new in mutation.edits:
                if text.count(old) != 1:
                    sys.exit(f"{path.relative_to(self.tree)}: not once there: {old.strip()}")
                text = text.replace(old, new)
            path.write_text(text)
        try:
            run(["cmake", "--build", self.build, "--target", "mpm3d-verification"])
            command = [sys.executable, "-m", "harness", "--quick", "--fresh"]
            command += ["--jobs", str(self.jobs)]
            command += ["--program", str(self.build / "bin" / "mpm3d-verification")]
            command += ["--records", str(self.build / "records")]
            command += [] if all_rows else ["--fail-fast"]
            result = subprocess.run(command, capture_output=True, text=True, check=False)
        finally:
            for path, original in originals.items():
                path.write_text(original)
        if result.returncode not in (0, 1):
            sys.exit(result.stderr)
        rows = re.findall(r"^ *\d+/\d+  FAILED +(.*)$", result.stdout, re.MULTILINE)
        return rows


def run(command: list[str | Path]) -> None:
    """Run a command; show its output when it fails."""
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{result.stdout}{result.stderr}")


if __name__ == "__main__":
    sys.exit(main())
