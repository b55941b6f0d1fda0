"""A program that uses the package, for mypy."""

import io
import pathlib

import numpy
from numpy.typing import NDArray
from PIL import Image

import gscl


def show(state: gscl.Progress) -> bool:
    print(f"{state.fraction:.0%} {state.psnr:.2f} dB")
    return state.elapsed_s < 60


def main(path: pathlib.Path) -> None:
    picture: NDArray[numpy.uint8] = numpy.zeros((32, 48, 3), numpy.uint8)
    data = gscl.encode(picture, bytes=300, effort=0, tune="psnr", effects_off=["texture"], progress=show)
    encoded: bytes = gscl.encode(Image.open(path), bpp=0.1, icc_profile=True)
    whole = gscl.encode(picture, packets=152, packet_count=10, packet_loss=0.2, effort=0)
    decoder = gscl.Decoder()
    new: list[bool] = [decoder.add(packet) for packet in whole.packets]
    print(new, whole.report.psnr, decoder.received, decoder.size, decoder.image(size=(96, 64)).shape)
    print(gscl.decode(whole.packets[2:]).shape)
    path.write_bytes(whole)
    with path.open("rb") as file:
        again: gscl.Encoded = gscl.encode(file, bytes=300)
    print(len(again), again.report, gscl.encode(io.BytesIO(again), psnr=25).report)
    print(gscl.devices().missing, gscl.devices()[0].why_default)
    rate: float = 8 * data.report.bytes / picture[:, :, 0].size
    drawn = gscl.decode(data, size=(96, 64), crop=(0, 0, 10, 10), dtype=numpy.float32, device="host", threads=2)
    drawn = gscl.decode(io.BytesIO(data), dtype=float, out=decoder.image(dtype=float, out=drawn))
    ellipses = gscl.splats(encoded)
    print(rate, drawn.shape, ellipses["x"].mean(), gscl.info(path).streams["position"], gscl.compare(picture, drawn).psnr)
    field: gscl.Field = gscl.fields.load_image_gs({"xy": numpy.zeros((0, 2))}, size=(96, 64), topk_norm=False)
    gscl.fields.save_npz(gscl.read_field(path), path.with_suffix(".npz"))
    memory = io.BytesIO()
    gscl.fields.save_npz(gscl.fields.load_npz(path), memory)
    with path.open("rb") as file:
        print(gscl.fields.load_gaussianimage(file, size=(96, 64)), gscl.fields.load_ply(memory))
    table = gscl.fields.load_csv("a.csv", size=(96, 64), blend="sum", background=[0.5])
    print(gscl.fields.tensors(table)["x"], gscl.pack(field, bytes=300).report.changed)
    try:
        gscl.decode(path, max_pixels=10**6)
    except gscl.LimitError as error:
        print(error.code, error)
