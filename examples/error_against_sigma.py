#!/usr/bin/python3
# %% [markdown]
# # Is sigma true?
# An event camera is simulated, its frames are compared with what an ideal camera would have
# shown, and the error of their pixels is plotted against the sigma that came with them. Cells as
# editors with notebooks know them; also a program: error_against_sigma.py [PLOT.svg [SECONDS]]

# %%
import sys

import eventide
import numpy as np

plot, seconds = "error_against_sigma.svg", 2.0
if "ipykernel" not in sys.modules:  # a notebook has arguments of its own
    try:
        plot, seconds = sys.argv[1:] + [plot, seconds][len(sys.argv) - 1 :]
        seconds = float(seconds)
        assert not plot.startswith("-")
    except (AssertionError, ValueError):
        sys.exit("error_against_sigma.py [PLOT.svg [SECONDS]]")

# %% Frames beside the truth of the same instants
simulation = eventide.simulate("demo", size=(96, 72), seconds=seconds, truths_per_second=50)
network = eventide.Reconstructor("default", simulation.width, simulation.height)
errors, sigmas, waiting = [], [], []
for events, truths in simulation:
    network.push(events)
    network.advance(simulation.clock)
    waiting += truths
    for t, truth in [each for each in waiting if network.ready(each[0])]:
        intensity, sigma = network.render(t)
        errors.append((intensity - truth).ravel())
        sigmas.append(sigma.ravel())
        waiting = [each for each in waiting if each[0] > t]
if not errors:
    sys.exit(f"{sys.argv[0]}: expected SECONDS long enough for a frame, found {seconds}")
error, sigma = np.concatenate(errors), np.concatenate(sigmas)

# %% Twelve bins of equally many pixels, by sigma
points = []
for pixels in np.array_split(np.argsort(sigma), 12):
    inside = np.abs(error[pixels]) <= 1.2816 * sigma[pixels]
    points.append((sigma[pixels].mean(), np.sqrt(np.mean(error[pixels] ** 2)), inside.mean()))
print("sigma  RMS error  within 1.28 sigma (.80 is right)")
for mean, rms, share in points:
    print(f"{mean:.3f}  {rms:.3f}      {share:.2f}")

# %% Where sigma is true, points lie on the diagonal
SIDE, EDGE = 360, 50
most = 1.05 * max(max(mean, rms) for mean, rms, _ in points)


def place(x, y):
    return EDGE + x / most * SIDE, EDGE / 2 + (1 - y / most) * SIDE


(left, bottom), (right, top) = place(0, 0), place(most, most)
shapes = [
    f'<svg xmlns="http://www.w3.org/2000/svg" width="{right + EDGE}" height="{bottom + EDGE}">',
    f'<g font-family="sans-serif" font-size="12" text-anchor="middle">'
    f'<rect width="100%" height="100%" fill="white"/>',
    f'<path d="M{left},{top}V{bottom}H{right}" fill="none" stroke="black"/>',
    f'<path d="M{left},{bottom}L{right},{top}" stroke="gray" stroke-dasharray="4"/>',
    f'<text x="{(left + right) / 2}" y="{bottom + 34}">sigma</text>',
    f'<text transform="translate(14 {(top + bottom) / 2}) rotate(-90)">RMS error</text>',
]
for mark in np.arange(0, most, 10 ** np.floor(np.log10(most / 2))):
    x, y = place(mark, mark)
    shapes.append(f'<text x="{x:.1f}" y="{bottom + 16}">{mark:.3g}</text>')
    shapes.append(f'<text x="{left - 16}" y="{y + 4:.1f}">{mark:.3g}</text>')
for mean, rms, _ in points:
    x, y = place(mean, rms)
    shapes.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="steelblue"/>')
with open(plot, "w") as out:
    out.write("\n".join(shapes) + "\n</g></svg>\n")
print(f"{error.size} pixels of {len(errors)} frames: {plot}")
