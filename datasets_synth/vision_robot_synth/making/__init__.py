"""Making datasets: frames with their truth, in any order, by any number of processes, into a folder."""

from vision_robot_synth.making.synthesise import Made, synthesise

__all__ = ["Made", "synthesise"]
