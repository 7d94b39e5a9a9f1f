"""The README of a dataset."""

from typing import Any

__all__ = ["readme_text"]

TEXT = """# {recipe}

{description}.

{count} frames of {width} x {height} px at {fps:g} frames a second, rendered in MuJoCo by `vr synth`
of Vision Robot {version}. The same command on the same machine gives the same bytes:

    vr synth {recipe} --severity {severity:g} --seed {seed} --frames {count} --size {width}x{height} -o DIR

| file | holds |
|---|---|
| `dataset.json` | recipe, seed, versions, camera, work plane, objects, where the rest is |
| `frames/000000.png` ... | the pictures, lossless |
| `truth/tracks.csv` | a row an object and frame: `frame,time_s,id,u_px,v_px,...`, pose, what is hidden |
{rows}

`vision_robot.dataset.open_dataset(DIR)` reads all of it; `dataset.json` is a file of camera and
work plane too. Pixels: (0, 0) is the centre of the first one, u right, v down. Lengths in the
tables are as their names say (px, mm); {{S}}, the station frame, lies on the table, z up.

Objects: {objects}.
"""

ROWS = {
    "masks": "`{pattern}` ... | id of the object at each pixel, 0 for none",
    "coco": "`{pattern}` | the same masks as COCO keeps them (run lengths)",
    "flow": "`{pattern}` ... | true flow to the frame {step} later: KITTI's 16 bits, blue 2: hidden",
    "mot": "`{pattern}`, `seqinfo.ini` | MOTChallenge: whole boxes; last column: visibility",
    "camera": "`{pattern}` | where the station stands before the moving camera",
}


def readme_text(described: dict[str, Any]) -> str:
    """The text for a dataset.json."""
    files = {**described["truth"], "camera": described.get("camera_motion")}
    rows = []
    for name, row in ROWS.items():
        if files.get(name):
            known = files[name] if isinstance(files[name], dict) else {"pattern": files[name]}
            rows.append("| " + row.format(**{**known, "pattern": known["pattern"].format(0)}) + " |")
    width, height = described["size"]
    objects = "; ".join(f"{one['id']} {one['name']} ({one['shape']})" for one in described["objects"])
    return TEXT.format(
        recipe=described["recipe"],
        description=described["description"],
        count=described["frames"]["count"],
        width=width,
        height=height,
        fps=described["fps"],
        version=described["versions"]["vision_robot"],
        severity=described["severity"],
        seed=described["seed"],
        rows="\n".join(rows),
        objects=objects or "none",
    )
