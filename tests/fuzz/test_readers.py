"""Whatever stands in a file, its reader reads it or refuses it in one line: no other error, no warning."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.fuzz.readers import SUBJECTS
from tests.fuzz.subject import Case, attempt

EXAMPLES = 10


@pytest.fixture(scope="module", params=SUBJECTS)
def good(request, tmp_path_factory):
    """A reader, its good files, and a folder to read in."""
    subject = SUBJECTS[request.param]
    place = tmp_path_factory.mktemp("fuzz")
    folder = place / "case"
    folder.mkdir()
    return subject, subject.seeds(place / "seeds"), folder


def test_good_files_are_read(good):
    subject, seeds, folder = good
    assert seeds
    assert [attempt(subject, Case(subject, seeds, k).write, folder) for k in range(len(seeds))] == [
        "read"
    ] * len(seeds)


@settings(max_examples=EXAMPLES)
@given(number=st.integers(0, 10**6))
def test_spoiled_files_are_read_or_refused(good, number):
    subject, seeds, folder = good
    assert attempt(subject, Case(subject, seeds, number).write, folder) in ("read", "refused")


def test_most_spoiled_files_are_refused(good):
    """So the test above sees spoiled files at all."""
    subject, seeds, folder = good
    ends = [attempt(subject, Case(subject, seeds, number).write, folder) for number in range(10, 40)]
    assert ends.count("refused") >= 5
