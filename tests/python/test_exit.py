"""Programs that end while a daemon thread of theirs is at work in the library."""

import subprocess
import sys
import unittest

WORK = {
    "a camera's events": "consume(camera)",
    "a camera's frames": "consume(eventide.read_frames(camera, eventide.Reconstructor('small', 64, 48, window='10ms')))",
    "a pipeline": "run(camera, note)",
    "a pipeline without threads": "run(camera, note, sequential=True)",
    "a slow sink": "run(camera, note_slowly)",
    "a slow sink without threads": "run(camera, note_slowly, sequential=True)",
    "a slow source": "run(map(note_slowly, camera), [])",
    "a source that waits for ever": "run(iter(waits, None), [])",
}
PROGRAM = """
import threading
import eventide

camera = eventide.open_camera("sim:demo?size=64x48&speed=max")
begun = threading.Event()


def note(seen):
    begun.set()


def note_slowly(seen):
    begun.set()
    return seen if sum(range(100_000)) > 0 else None


def waits():
    begun.set()
    threading.Event().wait()


def consume(iterable):
    for seen in iterable:
        note(seen)


def run(source, sink, **options):
    eventide.Pipeline(source, sink, "small", width=64, height=48, window="10ms", **options).run()


threading.Thread(target=lambda: {}, daemon=True).start()
begun.wait()
"""


class Exit(unittest.TestCase):
    def test_is_not_disturbed_by_daemon_threads(self):
        for name, work in WORK.items():
            with self.subTest(name):
                command = [sys.executable, "-c", PROGRAM.replace("{}", work)]
                ended = subprocess.run(command, capture_output=True, text=True)
                self.assertEqual((ended.returncode, ended.stderr), (0, ""))

    def test_is_not_disturbed_by_a_source_that_was_left_behind(self):
        left = """
import _thread
import threading
import eventide


def waits():
    _thread.interrupt_main()
    threading.Event().wait()


try:
    eventide.Pipeline(iter(waits, None), [], "small", width=64, height=48).run()
except KeyboardInterrupt:
    print("interrupted")
"""
        ended = subprocess.run([sys.executable, "-c", left], capture_output=True, text=True)
        self.assertEqual((ended.returncode, ended.stdout, ended.stderr), (0, "interrupted\n", ""))


if __name__ == "__main__":
    unittest.main()
