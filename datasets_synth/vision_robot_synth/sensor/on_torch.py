"""The same sensor for a batch of frames on a torch device, for people who train on what it makes."""

from typing import TYPE_CHECKING

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot_synth.sensor.compression import through_jpeg
from vision_robot_synth.sensor.noise import standard_normals
from vision_robot_synth.sensor.optics import disc_kernel, gaussian_kernel
from vision_robot_synth.sensor.video import VideoSensor

if TYPE_CHECKING:
    from torch import Tensor

__all__ = ["expose_batch"]


def expose_batch(
    sensor: VideoSensor, images: "Tensor", *, fps: float, first_frame: int = 0, seed: int = 0
) -> "Tensor":
    """Frames (n, 3, h, w), blue-green-red of 8 bits, as the camera delivers them, on the device they are on.

    Kernels, gains and noise are those of `VideoSensor.expose`, whose result this is but for
    rounding (one grey value in few pixels). JPEG runs on the CPU. Importing torch and kornia
    takes seconds, so nothing else here does.
    """
    import torch
    from kornia.filters import filter2d, filter2d_separable

    if images.ndim != 4 or images.shape[1] != 3 or images.dtype != torch.uint8:
        raise BadParameter("images", f"{images.dtype} {tuple(images.shape)}", "uint8 (n, 3, height, width)")
    device, (count, _, height, width) = images.device, images.shape

    def on_device(array: np.ndarray) -> "Tensor":
        return torch.from_numpy(np.ascontiguousarray(array)).to(device)

    light = images.float()
    if sensor.defocus_px:
        light = filter2d(light, on_device(disc_kernel(sensor.defocus_px))[None], "replicate")
    if sensor.blur_px:
        row = on_device(gaussian_kernel(sensor.blur_px))[None]
        light = filter2d_separable(light, row, row, "replicate")
    frames = range(first_frame, first_frame + count)
    gains = [sensor.gain((width, height), frame / fps, seed) for frame in frames]
    light = torch.stack(
        [
            one if gain is None else one * on_device(gain.transpose(2, 0, 1))
            for one, gain in zip(light, gains, strict=True)
        ]
    )
    if sensor.read_noise or sensor.shot_noise:
        normals = [standard_normals((height, width, 3), seed, frame) for frame in frames]
        noise = on_device(np.stack(normals).transpose(0, 3, 1, 2))
        light = light + noise * (sensor.read_noise**2 + sensor.shot_noise * light).clamp(min=0).sqrt()
    result = light.round().clamp(0, 255).to(torch.uint8)
    if sensor.jpeg:
        pictures = result.permute(0, 2, 3, 1).cpu().numpy()
        decoded = np.stack([through_jpeg(np.ascontiguousarray(one), sensor.jpeg) for one in pictures])
        result = on_device(decoded.transpose(0, 3, 1, 2))
    return result
