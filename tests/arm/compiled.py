"""An exported arm, compiled for this computer and called from Python."""

import ctypes
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from vision_robot.arm import read_arm
from vision_robot.arm.export_c import export_c
from vision_robot.arm.model import Arm
from vision_robot.geometry import SE3, SerialChain
from vision_robot.types import Array, Bool, Float

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-Wdouble-promotion", "-Wconversion")

HOOKS = """
#include "vr_link.h"
unsigned moved, stopped;
uint32_t last_time_ms;
vr_real last_joints[VR_JOINTS];
void vr_on_move(uint32_t time_ms, const vr_real joints[VR_JOINTS])
{
    int i;
    moved++;
    last_time_ms = time_ms;
    for (i = 0; i < VR_JOINTS; i++)
        last_joints[i] = joints[i];
}
void vr_on_stop(void) { stopped++; }
void solve_many(int count, const vr_real *goals, const vr_real *nows, vr_real *q, vr_real *errors,
                int *reached)
{
    int k;
    for (k = 0; k < count; k++)
        reached[k] = vr_solve(goals + 12 * k, nows + VR_JOINTS * k, q + VR_JOINTS * k, errors + 2 * k);
}
void link_at(vr_link *link, unsigned sequence) { link->sequence = (uint16_t)sequence; }
unsigned link_size(void) { return sizeof(vr_link); }
unsigned link_byte(vr_link *link, uint8_t byte, uint8_t *out)
{
    unsigned length = vr_link_byte(link, byte), i;
    for (i = 0; i < length; i++)
        out[i] = link->out[i];
    return length;
}
"""

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="no gcc on this machine")


class CompiledArm:
    """`vr_ik.c` and `vr_link.c` of one arm in a shared library."""

    def __init__(self, arm: Arm, folder: Path, *, flags: Sequence[str] = STRICT, **options: object):
        self.arm, self.folder, self.n = arm, folder, len(arm)
        self.export = export_c(arm, folder, **options)  # type: ignore[arg-type]
        (folder / "hooks.c").write_text(HOOKS)
        library = folder / "arm.so"
        sources = ["vr_ik.c", "vr_link.c", "hooks.c"]
        command = ["gcc", *flags, "-O2", "-shared", "-fPIC", *sources, "-o", library.name, "-lm"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        self.library = ctypes.CDLL(str(library))
        self.real = ctypes.c_float if self.export.precision.bytes == 4 else ctypes.c_double

    def array(self, values: Array) -> ctypes.Array:
        """Numbers as C takes them."""
        flat = np.asarray(values, dtype=float).ravel().tolist()
        return (self.real * len(flat))(*flat)

    def forward(self, q: Float[Array, "n"]) -> Float[Array, "12"]:
        pose = self.array(np.zeros(12))
        self.library.vr_forward(self.array(q), pose)
        return np.array(pose[:])

    def solve(
        self, goal: Float[Array, "12"], now: Float[Array, "n"]
    ) -> tuple[bool, Float[Array, "n"], Float[Array, "2"]]:
        q, error = self.array(np.zeros(self.n)), self.array(np.zeros(2))
        reached = self.library.vr_solve(self.array(goal), self.array(now), q, error)
        return bool(reached), np.array(q[:]), np.array(error[:])

    def solve_many(
        self, goals: Float[Array, "k 12"], nows: Float[Array, "k n"]
    ) -> tuple[Bool[Array, "k"], Float[Array, "k n"]]:
        """Whether each goal was reached, and the joints."""
        count = len(goals)
        q, errors, reached = self.array(nows), self.array(np.zeros(2 * count)), (ctypes.c_int * count)()
        self.library.solve_many(count, self.array(goals), self.array(nows), q, errors, reached)
        return np.array(reached[:], dtype=bool), np.array(q[:]).reshape(count, self.n)

    def branches(self, goal: Float[Array, "12"]) -> Float[Array, "k n"]:
        q = self.array(np.zeros(self.export.branches * self.n))
        found = self.library.vr_branches(self.array(goal), q)
        return np.array(q[:]).reshape(-1, self.n)[:found]


class CReceiver:
    """`vr_link` as a `Port`: what is written is fed to the C receiver, whose answers are read.

    `spoil` may change the bytes of either direction on their way.
    """

    name = "receiver in C"

    def __init__(self, compiled: CompiledArm, spoil=lambda data, _: data):
        self.compiled, self.library, self.spoil = compiled, compiled.library, spoil
        self.state = ctypes.create_string_buffer(self.library.link_size())
        self.out = ctypes.create_string_buffer(512)
        self.answers = bytearray()
        self.moves: list[tuple[int, list[float]]] = []
        self.restart()

    def restart(self) -> None:
        """As when the microcontroller is switched on."""
        middle = self.compiled.arm.chain.limits.mean(axis=1)
        self.library.vr_link_start(self.state, self.compiled.array(middle))

    def read(self, timeout_s: float) -> bytes:
        data, self.answers = bytes(self.answers), bytearray()
        return data

    def write(self, data: bytes) -> None:
        for byte in self.spoil(data, "there"):
            before = self.count("moved")
            length = self.library.link_byte(self.state, byte, self.out)
            if self.count("moved") != before:
                joints = (self.compiled.real * self.compiled.n).in_dll(self.library, "last_joints")
                self.moves.append((self.count("last_time_ms"), list(joints)))
            if length:
                self.answers += self.spoil(self.out.raw[:length], "back")

    def elapsed(self, ms: int) -> None:
        self.library.vr_link_elapsed(self.state, ctypes.c_uint32(ms))

    def count(self, name: str) -> int:
        return ctypes.c_uint32.in_dll(self.library, name).value


def goals_inside(arm: Arm, count: int, seed: int) -> tuple[Float[Array, "count n"], Float[Array, "count 12"]]:
    """Joints drawn inside the limits, and the pose of the tool at each."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(arm.chain.limits[:, 0], arm.chain.limits[:, 1], (count, len(arm)))
    return q, rows(arm.chain.base_from_tool(q))


def rows(pose: SE3) -> Float[Array, "*batch 12"]:
    """A pose as the exported code has it."""
    return pose.as_matrix()[..., :3, :].reshape(*pose.batch, 12)


def column_arm() -> Arm:
    return read_arm("column")


def arm_of(chain: SerialChain) -> Arm:
    return Arm(name="test", chain=chain, base="base", tool="tool")
