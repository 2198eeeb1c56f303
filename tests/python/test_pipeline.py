"""The pipeline of threads with sources and sinks of Python."""

import unittest

import eventide
import numpy as np
from recorded import REPEATABLE, RecordedTest


class Pipelines(RecordedTest):
    def frames_of(self, source, **more):
        frames = []

        def keep(frame):
            frames.append(np.stack([frame.intensity, frame.sigma]))

        pipeline = eventide.Pipeline(source, keep, "small", **{**REPEATABLE, **more})
        pipeline.run()
        self.assertEqual(pipeline.counters["frames"], len(frames))
        return np.array(frames)

    def test_a_reader_gives_the_frames_of_the_program(self):
        expected = self.frames_of_run()
        for sequential in (False, True):
            frames = self.frames_of(eventide.open(self.recording), sequential=sequential)
            np.testing.assert_array_equal(frames, expected)

    def test_arrays_of_any_size_give_the_frames_of_the_reconstructor(self):
        events = self.events()
        reconstructor = self.reconstructor()
        reconstructor.push(events)
        reconstructor.finish()
        expected = np.array([np.stack([f.intensity, f.sigma]) for f in reconstructor.frames()])
        parts = (events[i : i + 777] for i in range(0, len(events), 777))
        np.testing.assert_array_equal(self.frames_of(parts, width=64, height=48), expected)

    def test_a_sink_that_wants_no_more_ends_a_camera(self):
        camera = eventide.open_camera("sim:demo?size=64x48&speed=1")
        seen = []

        def three(frame):
            seen.append(frame.t)
            return len(seen) < 3

        eventide.Pipeline(camera, [three, lambda frame: None], "small", window="10ms").run()
        self.assertEqual(len(seen), 3)

    def test_what_a_source_or_sink_raises_comes_out(self):
        def broken():
            yield self.events()[:1000]
            raise KeyError("cable")

        with self.assertRaisesRegex(KeyError, "cable"):
            eventide.Pipeline(broken(), print, "small", width=64, height=48).run()

        def full(frame):
            raise OSError("disk")

        with self.assertRaisesRegex(OSError, "disk"):
            eventide.Pipeline(eventide.open(self.recording), full, "small").run()

    def test_what_cannot_run_is_refused(self):
        with self.assertRaisesRegex(eventide.UsageError, "width"):
            eventide.Pipeline([], print, "small")
        with self.assertRaisesRegex(eventide.UsageError, "speed"):
            eventide.Pipeline([], print, "small", width=4, height=4, speed=3)


if __name__ == "__main__":
    unittest.main()
