"""A recording of the project's own, and what `eventide run` makes of it."""

import os
import pathlib
import subprocess
import tempfile
import unittest

import eventide
import numpy as np

PROGRAM = os.environ["EVENTIDE_PROGRAM"]
REPEATABLE = {"window": "7ms", "lookahead": 1, "fps": "100", "precision": "f32", "kernels": "own"}
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
    def frames_of_run(cls):
        """Intensity and sigma of each frame."""
        options = [x for k, v in REPEATABLE.items() for x in ("--" + k, str(v))]
        out = cls.folder / "frames"
        command = [PROGRAM, "run", cls.recording, "--model", "small", "--overwrite", "--frames", "ignore"]
        command += options
        command += ["--uncertainty", "separate", "--sigma-white", "1", "--out", f"grayf32:{out}"]
        subprocess.run(command, check=True, capture_output=True)
        return np.fromfile(out, np.float32).reshape(-1, 2, 48, 64)

    @staticmethod
    def reconstructor(**options):
        return eventide.Reconstructor("small", 64, 48, **{**REPEATABLE, **options})

    @classmethod
    def events(cls):
        return np.concatenate(list(eventide.open(cls.recording)))
