"""Many small measurements, each made once: in parallel, on a cluster, killed and resumed."""

from vision_robot.evaluate.sweep.cell import Cell, Measured, Outcome
from vision_robot.evaluate.sweep.run import run_sweep
from vision_robot.evaluate.sweep.store import Store

__all__ = ["Cell", "Measured", "Outcome", "Store", "run_sweep"]
