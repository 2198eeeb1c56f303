"""A recording of the project's own, and what `eventide run` makes of it."""

import os
import pathlib
import socket
import subprocess
import tempfile
import unittest

import eventide
import numpy as np

PROGRAM = os.environ["EVENTIDE_PROGRAM"]
REPEATABLE = {"window": "7ms", "lookahead": 1, "fps": "100", "precision": "f32", "kernels": "own"}
DATAGRAM = np.dtype([("t", "<u8"), ("x", "<u2"), ("y", "<u2"), ("on", "u1")])
DTYPE = np.dtype([("t", "<i8"), ("x", "<u2"), ("y", "<u2"), ("on", "?")])


class RecordedTest(unittest.TestCase):
    """64x48 px, 0.3 s, images every 40 ms, and a folder of its own."""

    @classmethod
    def setUpClass(cls):
        cls._folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls._folder.cleanup)
        cls.folder = pathlib.Path(cls._folder.name)
        cls.recording = cls.folder / "recording.aedat4"
        command = [PROGRAM, "simulate", "--scene", "demo", "--seconds", "0.3", "--size", "64x48"]
        subprocess.run(command + ["--out", cls.recording], check=True, capture_output=True)

    @classmethod
    def frames_of_run(cls, frames="auto"):
        """Intensity and sigma of each frame; frames: whether the camera's images correct them."""
        options = [x for k, v in REPEATABLE.items() for x in ("--" + k, str(v))]
        out = cls.folder / "frames"
        command = [PROGRAM, "run", cls.recording, "--model", "small", "--overwrite", "--frames", frames]
        command += options
        command += ["--uncertainty", "separate", "--sigma-white", "1", "--out", f"grayf32:{out}"]
        subprocess.run(command, check=True, capture_output=True)
        return np.fromfile(out, np.float32).reshape(-1, 2, 48, 64)

    @staticmethod
    def reconstructor(**options):
        return eventide.Reconstructor("small", 64, 48, **{**REPEATABLE, **options})

    def udp_camera(self):
        """A camera of 64x48 px, and a function that sends it (t, x, y, on) in a datagram."""
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            address = free.getsockname()
        sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.addCleanup(sender.close)
        camera = eventide.open_camera(f"udp://127.0.0.1:{address[1]}?size=64x48&format=t64")
        return camera, lambda events: sender.sendto(np.array(events, DATAGRAM).tobytes(), address)

    @classmethod
    def events(cls):
        return np.concatenate(list(eventide.open(cls.recording)))
