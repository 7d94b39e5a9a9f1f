"""Hand-eye in closed form: by name, each in its own file.

Each takes the arm's poses ``mount_from_far`` and the pictures' ``cam_from_board`` of the same views and
gives (mount_from_cam, far_from_board). They weigh all motions alike and know no noise: good starts,
and what the joint refinement is measured against.
"""

import importlib
from collections.abc import Callable

from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3

__all__ = ["CLOSED_FORMS", "closed_form"]

CLOSED_FORMS = {
    "tsai-lenz": "vision_robot.calibrate.hand_eye.closed_forms.tsai_lenz:solve",
    "park-martin": "vision_robot.calibrate.hand_eye.closed_forms.park_martin:solve",
    "daniilidis": "vision_robot.calibrate.hand_eye.closed_forms.daniilidis:solve",
    "shah": "vision_robot.calibrate.hand_eye.closed_forms.shah:solve",
}


def closed_form(name: str) -> Callable[[SE3, SE3], tuple[SE3, SE3]]:
    """The closed form of that name; raises BadParameter listing all."""
    if name not in CLOSED_FORMS:
        raise BadParameter("closed form", name, f"one of {', '.join(CLOSED_FORMS)}")
    module, function = CLOSED_FORMS[name].split(":")
    return getattr(importlib.import_module(module), function)
