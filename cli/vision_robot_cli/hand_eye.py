"""`vr extrinsics hand-eye`: photos of a board and the arm's poses in; where the camera sits out."""

__all__ = ["hand_eye"]


def hand_eye() -> None:
    """Where the camera sits on the arm, or beside it.

    Example: vr extrinsics hand-eye photos/*.jpg --poses poses.csv --camera camera.yaml
    """
