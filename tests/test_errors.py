"""Proves that every error comes back from another process with its message and its evidence."""

import inspect
import pickle

import pytest

from vision_robot import errors

CLASSES = [cls for _, cls in inspect.getmembers(errors, inspect.isclass) if issubclass(cls, Exception)]


def test_all_are_exported_and_have_one_root():
    assert {cls.__name__ for cls in CLASSES} == set(errors.__all__)
    assert all(issubclass(cls, errors.VisionRobotError) for cls in CLASSES)


@pytest.mark.parametrize("cls", CLASSES)
def test_a_pickled_error_keeps_message_and_evidence(cls):
    error = cls.__new__(cls, "what went wrong")
    error.evidence = ("a", 1)
    back = pickle.loads(pickle.dumps(error))
    assert type(back) is cls
    assert (str(back), back.evidence) == ("what went wrong", ("a", 1))


def test_one_in_full():
    back = pickle.loads(pickle.dumps(errors.MissingOpenGL({"EGL": "no libEGL"})))
    assert back.tried == {"EGL": "no libEGL"}
    assert "EGL: no libEGL" in str(back)
