"""Moves the splats of a file towards a picture with PyTorch, and packs them again: for experiments, slow and for small pictures.

    python differentiable_renderer.py small.png small.gscl 600 100
"""

import argparse
import dataclasses
import math
import pathlib

import gscl
import numpy
import torch
from PIL import Image


def draw(splats, field):
    """The picture: (height, width, 3), not clamped, from tensors of gscl.fields.tensors."""
    s = {name: value[:, None, None] for name, value in splats.items() if name != "colour"}
    y, x = torch.meshgrid(torch.arange(field.height) + 0.5, torch.arange(field.width) + 0.5, indexing="ij")
    dx, dy = x - s["x"], y - s["y"]
    c, n = torch.cos(s["theta"]), torch.sin(s["theta"])
    q = (((c * dx + n * dy) / s["sigma1"]) ** 2 + ((c * dy - n * dx) / s["sigma2"]) ** 2) / 2
    weight = s["opacity"] * torch.relu(torch.exp(-q) - math.exp(-gscl.CUTOFF))
    wave = s["wave_amplitude"] * torch.cos(2 * math.pi * (s["wave_x"] * dx + s["wave_y"] * dy - s["wave_phase"]))
    value = torch.einsum("nyx,nc->yxc", weight, splats["colour"][:, :3]) + (weight * wave).sum(0)[:, :, None]
    if field.blend == "sum":
        return value + torch.tensor(field.background[:3])
    behind = gscl.BACKGROUND_WEIGHT * torch.tensor(field.background[:3])
    return (value + behind) / (weight.sum(0)[:, :, None] + gscl.BACKGROUND_WEIGHT)


def main():
    parser = argparse.ArgumentParser()
    for name, kind in (("picture", str), ("output", str), ("bytes", int), ("steps", int)):
        parser.add_argument(name, type=kind)
    options = parser.parse_args()
    picture = numpy.asarray(Image.open(options.picture).convert("RGB"))
    field = gscl.read_field(gscl.encode(picture, bytes=options.bytes, effort=0, blend="normalized"))
    splats = gscl.fields.tensors(field)
    rates = {"x": 0.1, "y": 0.1, "sigma1": 0.05, "sigma2": 0.05, "theta": 0.01, "colour": 0.003}
    optimizer = torch.optim.Adam([{"params": [splats[name].requires_grad_()], "lr": rate} for name, rate in rates.items()])
    for step in range(options.steps):
        loss = ((draw(splats, field) - torch.from_numpy(picture / numpy.float32(255))) ** 2).mean()
        loss.backward()
        optimizer.step()
        optimizer.zero_grad()
        print(f"{step:4d}  {-10 * math.log10(loss.item()):.2f} dB")
    moved = field.splats.copy()
    for name in rates:
        moved[name] = splats[name].detach().numpy().clip(0.5 if "sigma" in name else None)
    changed = dataclasses.replace(field, splats=moved, steps=None)  # these splats are no codes of the file
    packed = gscl.pack(changed, bytes=options.bytes, reference=picture)
    pathlib.Path(options.output).write_bytes(packed)
    print(packed.report)


if __name__ == "__main__":
    main()
