"""`vr track pick`: which colour to track, and what its mask would be."""

from pathlib import Path
from typing import Annotated

import typer

from vision_robot_cli.options import Json, Out
from vision_robot_cli.track_options import Color, Pick, Roi, Set

__all__ = ["pick"]


def pick(
    image: Annotated[Path, typer.Argument(help="A picture, or a video whose first frame is taken.")],
    color: Color = None,
    pick: Pick = None,
    roi: Roi = None,
    set_: Set = None,
    out: Out = None,
    json: Json = False,
) -> None:
    """Choose a colour for the tracker rgb: what stands out, and the mask that a name, point or box gives.

    Without --color, --pick or --roi the colour that stands out most is shown; -o writes the picture with
    the mask.

    Example: vr track pick frame.png --pick 320,240 -o mask.png
    """
    import cv2

    from vision_robot.errors import UnwritableOutput
    from vision_robot.files import write_bytes
    from vision_robot.images import VIDEO_SUFFIXES, read_image
    from vision_robot.track.admission import Admission
    from vision_robot.track.colour_pick import suggestions
    from vision_robot.track.follow import Follower, FollowOptions
    from vision_robot.track.overlay import Overlay
    from vision_robot.video import Video
    from vision_robot_cli.output import emit_json, note
    from vision_robot_cli.track_input import tracker_of

    is_video = image.suffix.lower() in VIDEO_SUFFIXES
    shown = next(iter(Video(image))).image if is_video else read_image(image)
    frame = Admission().converted(shown)
    tracker = tracker_of("rgb", set_ or (), None, color=color or (), pick=pick or (), roi=roi or ())
    blobs = tracker.step(frame, 0.0)
    found = suggestions(frame)
    inside = frame[tracker.mask > 0]
    result = {
        "objects": len(blobs),
        "share": float((tracker.mask > 0).mean()),
        "rgb": {
            "mean": inside.mean(axis=0)[::-1] if len(inside) else None,
            "low": inside.min(axis=0)[::-1] if len(inside) else None,
            "high": inside.max(axis=0)[::-1] if len(inside) else None,
        },
        "blobs": [
            {"u_px": u, "v_px": v, "area_px": area}
            for (u, v), area in zip(blobs.centroid_px, blobs.area_px, strict=True)
        ],
        "remarks": [{"tone": tone, "text": text} for tone, text in tracker.remarks()],
        "suggestions": found,
        "out": str(out) if out else None,
    }
    if out:
        rows = Follower((frame.shape[1], frame.shape[0]), FollowOptions(confirm=1)).step(0, 0.0, blobs)
        coded, data = cv2.imencode(out.suffix or ".png", Overlay().draw(frame, tracker.mask, rows))
        if not coded:
            raise UnwritableOutput(out, "no picture format is called so")
        write_bytes(out, data.tobytes())
        note(f"mask shown in {out}")
    if json:
        emit_json("track.pick", result)
        return
    print(f"{len(blobs)} blob(s), {100 * result['share']:.2g} % of the picture")
    if len(inside):
        mean, low, high = (
            "({:.0f}, {:.0f}, {:.0f})".format(*result["rgb"][name]) for name in ("mean", "low", "high")
        )
        print(f"red, green, blue: mean {mean}, from {low} to {high}")
    for _, text in tracker.remarks():
        print(f"- {text}")
    for one in found[:6]:
        at = f"--pick {one.u_px},{one.v_px}"
        seen = f"{one.things} thing(s), {100 * one.share:.2g} % of the picture"
        print(f"suggested: --color {one.colour} or {at} ({seen})")
