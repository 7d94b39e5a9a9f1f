"""Pictures recorded by a robot: ROS 1 bags and ROS 2 bags (MCAP, SQLite), read without ROS.

Needs the package rosbags, an extra: ``pip install 'vision-robot[ros]'``.
"""

from .bag import BAG_SUFFIXES, Bag, is_bag

__all__ = ["BAG_SUFFIXES", "Bag", "is_bag"]
