#!/usr/bin/env python3
"""The same job as a pipeline script does it: OpenImageIO in, NumPy, OpenImageIO out.

    numpy_oiio.py IN OUT

Exponential height fog over R, G, B by the depth Z; other channels pass through.
"""
import sys

import numpy as np
import OpenImageIO as oiio

DENSITY, FALLOFF, COLOR = 2e-4, 5e-3, np.array([0.6, 0.65, 0.7], np.float32)


def main(source, target):
    image = oiio.ImageBuf(source)
    spec = image.spec()
    pixels = image.get_pixels(oiio.FLOAT)
    channel = {name: i for i, name in enumerate(spec.channelnames)}
    z = np.minimum(pixels[:, :, channel["Z"]], np.float32(1e5))
    mu = np.linspace(0.3, -0.3, spec.height, dtype=np.float32)[:, None]
    x = FALLOFF * mu * z
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = DENSITY * z * np.where(np.abs(x) < 1e-6, 1, -np.expm1(-x) / x)
    transmittance = np.exp(-depth)[:, :, None]
    rgb = [channel["R"], channel["G"], channel["B"]]
    pixels[:, :, rgb] = pixels[:, :, rgb] * transmittance + (1 - transmittance) * COLOR
    out = oiio.ImageBuf(spec)
    out.set_pixels(spec.roi, pixels)
    if not out.write(target):
        sys.exit(out.geterror())


main(*sys.argv[1:])
