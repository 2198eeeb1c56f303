#!/usr/bin/python3
"""reconstruct.py RECORDING OUT: intensity and sigma of each frame, as rows of float32."""
import sys

import eventide

if len(sys.argv) != 3:
    sys.exit(__doc__)
recording, out_name = sys.argv[1:]
reader = eventide.open(recording)
reconstructor = eventide.Reconstructor(
    "default", reader.width, reader.height, window="auto", lookahead=2, lamp_flicker="16ms",
    precision="f32",
)
with open(out_name, "wb") as out:
    for frame in eventide.read_frames(reader, reconstructor):
        frame.intensity.tofile(out)
        frame.sigma.tofile(out)
