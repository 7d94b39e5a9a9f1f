"""What `vr benchmark` measures on rendered data: suites of cells, and the work each cell does."""

from vision_robot_synth.suites.suite import SUITES, Plan, Suite, suite_named

__all__ = ["SUITES", "Plan", "Suite", "suite_named"]
