"""Encodes an array within its budget with the installed package, and decodes it."""

import numpy

import gscl

y, x = numpy.mgrid[0:48, 0:64]
picture = numpy.stack([4 * x, 5 * y, 255 - 2 * x], axis=-1).astype(numpy.uint8)
data = gscl.encode(picture, bytes=300, effort=0, device="host")
psnr = gscl.compare(picture, gscl.decode(data)).psnr
assert len(data) <= 300 and psnr > 30, (len(data), psnr)
print(f"gscl {gscl.__version__}: {len(data)} bytes, {psnr:.2f} dB on {gscl.devices()[0].name}")
