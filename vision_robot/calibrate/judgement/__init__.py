"""How far a calibration can be believed, what it lacks, and what to photograph next.

`judge` asks everything; each question has a file of its own. All start from `solution`, the
state and problem as the solver left them.
"""

from vision_robot.calibrate.judgement.judge import Judgement, judge

__all__ = ["Judgement", "judge"]
