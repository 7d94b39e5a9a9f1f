"""The page's sections of judgement say what was asked, and stay out where nothing was."""

from dataclasses import replace

import numpy as np

from tests.views import CAMERAS, make_views
from vision_robot.calibrate import Settings, calibrate
from vision_robot.calibrate.judgement import judge
from vision_robot.calibrate.judgement.selection import Selection
from vision_robot.report.calibration import calibration_page
from vision_robot.report.judgement_sections import judgement_sections, selection_section
from vision_robot.report.page import render_page

SIZE = (1280, 960)


def judged():
    views = make_views(CAMERAS["pinhole"], 8, seed=1)
    result = calibrate(views.corners, views.board, SIZE, Settings(model="pinhole"))
    return result, judge(result, views.board)


def test_every_answer_has_its_place():
    result, judgement = judged()
    page = render_page(calibration_page(result, judgement=judgement))
    for title in ("Can it be believed", "Where the error comes from", "What to photograph next"):
        assert title in page
    assert judgement.next_views is not None
    assert judgement.next_views.words[0][1:] in page


def test_unanswered_questions_are_said_and_leave_no_empty_section():
    result, judgement = judged()
    silent = replace(judgement, error_budget=None, next_views=None, unanswered={"halves": "too few views"})
    sections = judgement_sections(silent, result.camera)
    assert [section.title for section in sections] == ["Can it be believed"]
    assert "too few views" in str(sections[0])


def test_candidates_are_listed_with_the_reason():
    names = (Settings(model="pinhole"), Settings(model="brown5", warp=2))
    numbers = np.array([0.5, 0.2])
    selection = Selection(names, (4, 20), numbers, numbers, numbers, numbers, ("far behind", "chosen"), 1, 1)
    text = str(selection_section(selection))
    assert "brown5, board degree 2" in text
    assert "far behind" in text
