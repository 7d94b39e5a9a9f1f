"""Proves that wheel and sdist are whole: built, installed into an empty environment, and used from there.

Nothing is downloaded: the empty environment sees the packages of the one that runs the tests, but not
the project, which is installed there as an editable clone.
"""

import os
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tomllib
import zipfile
from pathlib import Path

import pytest
from packaging.metadata import Metadata
from packaging.requirements import Requirement

import vision_robot

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
PACKAGES = {
    "vision_robot": ROOT / "vision_robot",
    "vision_robot_cli": ROOT / "cli/vision_robot_cli",
    "vision_robot_synth": ROOT / "datasets_synth/vision_robot_synth",
}
pytestmark = pytest.mark.skipif(os.name == "nt", reason="paths of the environment are those of Unix")


def build(kind: str, source: Path, folder: Path) -> Path:
    command = [sys.executable, "-m", "hatchling", "build", "--target", kind, "--directory", str(folder)]
    subprocess.run(command, cwd=source, check=True, capture_output=True, timeout=120)
    (made,) = folder.glob("*.whl" if kind == "wheel" else "*.tar.gz")
    return made


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    return build("wheel", ROOT, tmp_path_factory.mktemp("wheel"))


def names_in(wheel: Path) -> set[str]:
    with zipfile.ZipFile(wheel) as archive:
        return {name for name in archive.namelist() if ".dist-info/" not in name}


def metadata_of(wheel: Path) -> bytes:
    with zipfile.ZipFile(wheel) as archive:
        (name,) = (name for name in archive.namelist() if name.endswith(".dist-info/METADATA"))
        return archive.read(name)


def test_the_wheel_holds_every_file_of_the_packages_and_no_other(wheel):
    ours = {
        f"{package}/{path.relative_to(folder).as_posix()}"
        for package, folder in PACKAGES.items()
        for path in folder.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert names_in(wheel) == ours
    assert wheel.stat().st_size < 2e6


def test_the_metadata_are_valid_and_say_what_pyproject_says(wheel):
    raw = metadata_of(wheel)
    found = Metadata.from_email(raw, validate=True)
    assert (found.name, str(found.version)) == (PROJECT["name"], vision_robot.__version__)
    assert found.license_expression == PROJECT["license"]
    assert found.license_files == PROJECT["license-files"]
    assert found.description_content_type == "text/markdown"
    assert raw.partition(b"\n\n")[2] == (ROOT / "README.md").read_bytes()
    extras = PROJECT["optional-dependencies"]
    assert found.provides_extra == sorted(extras)
    asked = {Requirement(one) for one in PROJECT["dependencies"]}
    assert {one for one in found.requires_dist or () if one.marker is None} == asked
    assert len(found.requires_dist or ()) == len(asked) + sum(map(len, extras.values()))


def test_the_sdist_makes_the_same_wheel(wheel, tmp_path):
    sdist = build("sdist", ROOT, tmp_path)
    with tarfile.open(sdist) as archive:
        archive.extractall(tmp_path / "source", filter="data")
    (source,) = (tmp_path / "source").iterdir()
    again = build("wheel", source, tmp_path / "again")
    with zipfile.ZipFile(wheel) as one, zipfile.ZipFile(again) as other:
        assert {info.filename: info.CRC for info in one.infolist()} == {
            info.filename: info.CRC for info in other.infolist()
        }


def test_the_version_is_written_in_one_place():
    assert PROJECT["dynamic"] == ["version"]
    assert "version" not in PROJECT
    written = [
        path
        for folder in PACKAGES.values()
        for path in folder.rglob("*.py")
        if "__version__ =" in path.read_text(encoding="utf-8")
    ]
    assert written == [ROOT / "vision_robot/__init__.py"]


@pytest.fixture(scope="module")
def environment(wheel, tmp_path_factory):
    """An environment with the wheel alone, its dependencies lent by ours."""
    folder = tmp_path_factory.mktemp("environment") / "env"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder)], check=True, timeout=120)
    python = folder / "bin/python"
    uv = shutil.which("uv") or shutil.which("uv", path=str(Path(sys.executable).parent))
    if uv:
        install = [uv, "pip", "install", "--offline", "--quiet", "--python", str(python)]
    else:
        install = [sys.executable, "-m", "pip", "--python", str(python), "install", "--no-index", "--quiet"]
    subprocess.run([*install, "--no-deps", str(wheel)], check=True, timeout=120)
    (site,) = folder.glob("lib/python*/site-packages")
    # A path added by a .pth file has no .pth files read itself: our editable clone stays out of sight.
    (site / "lent.pth").write_text(sysconfig.get_path("purelib") + "\n")
    return folder


def said(environment: Path, *words: str, folder: Path) -> str:
    program = [str(environment / "bin" / words[0]), *words[1:]]
    ended = subprocess.run(program, cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


def test_the_installed_wheel_works_away_from_the_clone(environment, tmp_path):
    for package in PACKAGES:
        script = f"import {package}; print({package}.__file__)"
        assert str(environment) in said(environment, "python", "-c", script, folder=tmp_path)
    assert said(environment, "vr", "--version", folder=tmp_path) == f"vr {vision_robot.__version__}\n"


@pytest.mark.parametrize(
    ("words", "shows"),
    [
        (["schema"], "calibrate"),  # schemas
        (["synth", "--list"], "many-objects"),  # recipes
        (["ik", "solve", "--position", "350,100,150mm", "--yaw", "30deg"], "1 of 1 goals reached"),  # the arm
        (["ik", "export", "-o", "c"], "closed form"),  # sources of the C code
        (["board", "-o", "board.pdf"], "chessboard 9x6"),
    ],
)
def test_the_files_beside_the_code_are_found(environment, tmp_path, words, shows):
    assert shows in said(environment, "vr", *words, folder=tmp_path)


def test_reports_find_their_template(environment, tmp_path):
    words = ["ik", "check", "column", "--report", "arm.html"]
    said(environment, "vr", *words, folder=tmp_path)
    assert "<html" in (tmp_path / "arm.html").read_text()
