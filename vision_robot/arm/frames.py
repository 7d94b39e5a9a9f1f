"""The frames algebra of a vision-guided arm."""

from vision_robot.geometry import SE3

__all__ = ["base_from_tool", "base_from_wrist"]


def base_from_wrist(base_from_station: SE3, station_from_goal: SE3, wrist_from_tool: SE3) -> SE3:
    """Where the wrist has to be for the tool to stand on the goal, {T} = {G}.

    B_T_W = B_T_S S_T_G (W_T_T)^-1: station in the base, goal on the station, tool in the wrist.
    """
    return base_from_station @ station_from_goal @ wrist_from_tool.inverse()


def base_from_tool(base_from_station: SE3, station_from_goal: SE3) -> SE3:
    """Where the tool has to be in the base to stand on the goal, {T} = {G}."""
    return base_from_station @ station_from_goal
