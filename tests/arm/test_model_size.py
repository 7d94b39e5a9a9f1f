"""MJCF files that ask for more than any arm has are refused before MuJoCo makes it."""

import pytest

from vision_robot.arm import read_arm
from vision_robot.errors import BadArm

JOINT = '<joint name="j" axis="0 0 1" range="-1 1" limited="true"/>'
BODY = f'<body>{JOINT}<geom size=".1"/>{{}}<site name="tool"/></body>'


def model(inside: str = "", before: str = "") -> str:
    return f"<mujoco>{before}<worldbody>{BODY.format(inside)}</worldbody></mujoco>"


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (
            model('<replicate count="1000"><replicate count="10"><geom size=".1"/></replicate></replicate>'),
            "1e+04",
        ),
        (model(before='<size nkey="1000000"/>'), "size"),
        (
            model(before='<asset><texture name="t" builtin="flat" width="90000" height="90000"/></asset>'),
            "texture",
        ),
        (model('<body pos="nan 0 0"/>'), "not a finite number"),
        (model('<site name="wrist" pos="0 0 1e7"/>'), "m away"),
    ],
)
def test_what_is_too_much_is_named(tmp_path, text, why):
    (tmp_path / "a.xml").write_text(text)
    with pytest.raises(BadArm, match=why.replace("+", r"\+")):
        read_arm(tmp_path / "a.xml")


def test_what_it_includes_counts(tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts/b.xml").write_text('<mujoco><size nuserdata="1000000"/></mujoco>')
    (tmp_path / "a.xml").write_text(model(before='<include file="parts/b.xml"/>'))
    with pytest.raises(BadArm, match="size"):
        read_arm(tmp_path / "a.xml")


def test_an_ordinary_model_with_copies_is_read(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    inside = '<replicate count="20" offset="0 0 .1"><geom size=".01"/></replicate>'
    (tmp_path / "a.xml").write_text(model(inside))
    assert len(read_arm(tmp_path / "a.xml")) == 1


def test_mujoco_leaves_no_log_behind(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.xml").write_text(model('<body pos="nan 0 0"/>'))
    with pytest.raises(BadArm):
        read_arm(tmp_path / "a.xml")
    assert [path.name for path in tmp_path.iterdir()] == ["a.xml"]
