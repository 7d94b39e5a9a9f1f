"""Trying something in a process of its own, because drivers and codecs may crash it or chatter on stderr."""

import os
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from typing import TypeVar

__all__ = ["Crashed", "apart"]

Result = TypeVar("Result")


class Crashed(Exception):
    """The trial took its process down."""


def apart(trial: Callable[[], Result]) -> Result:
    """What `trial()`, a function of a module, returns in a fresh process that cannot be heard.

    Raises Crashed where that process ends before its answer.
    """
    with ProcessPoolExecutor(1, mp_context=get_context("spawn"), initializer=_silence) as pool:
        try:
            return pool.submit(trial).result()
        except BrokenProcessPool as error:
            raise Crashed("it crashed the process that tried it") from error


def _silence() -> None:
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
