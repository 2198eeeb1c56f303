"""The pipeline of threads with sources and sinks of Python."""

import gc
import threading
import unittest
import weakref

import eventide
import numpy as np
from recorded import DTYPE, REPEATABLE, RecordedTest


class Wrapped:
    """A reader as a source of one's own."""

    def __init__(self, reader):
        self.reader, self.width, self.height = reader, reader.width, reader.height
        self.images = []

    def __iter__(self):
        for events in self.reader:
            self.images = self.reader.images
            yield events


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

    def test_a_size_that_is_given_is_that_of_the_sensor(self):
        for source in (eventide.open(self.recording), Wrapped(eventide.open(self.recording))):
            self.assertEqual(self.frames_of(source, width=100, height=80).shape[2:], (80, 100))

    def frames_one_by_one(self, source, **more):
        reconstructor = self.reconstructor(**more)
        frames = []
        while source.read_into(reconstructor):
            frames += reconstructor.frames()
        reconstructor.finish(source.clock)
        frames += reconstructor.frames()
        return np.array([np.stack([f.intensity, f.sigma]) for f in frames])

    def test_a_reader_tells_the_times_of_its_images(self):
        expected = self.frames_one_by_one(eventide.open(self.recording), window="aps")
        frames = self.frames_of(eventide.open(self.recording), window="aps")
        np.testing.assert_array_equal(frames, expected)
        events = (events for events in eventide.open(self.recording))
        otherwise = self.frames_of(events, window="aps", width=64, height=48)
        self.assertFalse(np.array_equal(otherwise, expected), "the times show")

    def test_an_iterable_with_images_has_them_correct_frames(self):
        reader, reconstructor = eventide.open(self.recording), self.reconstructor()
        for events in reader:
            for t, image in reader.images:
                reconstructor.push_image(t, image)
            reconstructor.push(events, resets=True)
        reconstructor.finish()
        expected = [np.stack([f.intensity, f.sigma]) for f in reconstructor.frames()]
        self.assertGreater(reconstructor.counters["used_images"], 5)
        frames = self.frames_of(Wrapped(eventide.open(self.recording)))
        np.testing.assert_array_equal(frames, expected)

        class Wrong(Wrapped):
            images = property(lambda self: [(1, "no pixels")], lambda self, new: None)

        with self.assertRaisesRegex(TypeError, "images"):
            self.frames_of(Wrong(eventide.open(self.recording)))

    def test_images_that_are_told_once_are_not_lost(self):
        class Queued(Wrapped):
            images = property(lambda self: self.queue.pop(), lambda self, new: setattr(self, "queue", [new]))

        expected = self.frames_of(Wrapped(eventide.open(self.recording)))
        frames = self.frames_of(Queued(eventide.open(self.recording)))
        np.testing.assert_array_equal(frames, expected)

    def test_what_an_attribute_of_a_source_raises_comes_out(self):
        def fail(self, *given):
            raise OSError("camera gone")

        for name in ("images", "clock", "gap_before", "width"):
            failing = type("Failing", (Wrapped,), {name: property(fail, lambda self, new: None)})
            with self.assertRaisesRegex(OSError, "camera gone"):
                self.frames_of(failing(eventide.open(self.recording)))

    def test_a_sink_that_is_a_list_besides_is_called(self):
        class Kept(list):
            __call__ = list.append

        kept = Kept()
        eventide.Pipeline(eventide.open(self.recording), kept, "small", **REPEATABLE).run()
        self.assertGreater(len(kept), 25)

    def test_sinks_that_cannot_be_called_are_refused_before_anything_is_read(self):
        for sinks, named in ((None, "None"), ([print, 5], "5"), ("frames.mp4", "'f'")):
            with self.assertRaisesRegex(TypeError, f"sinks: expected a callable.*{named}"):
                eventide.Pipeline(eventide.open(self.recording), sinks, "small")

    def test_a_simulation_as_fast_as_it_can_be_waits_for_its_frames(self):
        name = "sim:demo?size=64x48&seconds=0.3&speed=max"
        expected = self.frames_one_by_one(eventide.open_camera(name))
        frames = self.frames_of(eventide.open_camera(name), latency=1e-6)
        np.testing.assert_array_equal(frames, expected)

    def test_a_camera_gives_frames_while_nothing_moves(self):
        for sequential in (False, True):
            camera, send = self.udp_camera()
            send([(1000 + i, i % 64, 5, 1) for i in range(100)])
            seen = []

            def twenty(frame):
                seen.append(frame.t)
                return len(seen) < 20

            options = {"window": "10ms", "fps": "100", "noise_filter": "off", "sequential": sequential}
            eventide.Pipeline(camera, twenty, "small", **options).run()
            self.assertGreater(seen[-1], 100_000)

    def test_a_live_source_of_ones_own_tells_its_clock_and_its_gaps(self):
        class Live:
            width, height, gap_before, clock = 64, 48, False, None

            def __iter__(self):
                for n in range(1, 31):
                    events = np.zeros(1 if n in (1, 5) else 0, DTYPE)
                    events["t"], self.clock, self.gap_before = 10_000 * n - 1, 10_000 * n, n == 5
                    yield events

        seen = []
        options = {**REPEATABLE, "window": "10ms", "lookahead": 0, "noise_filter": "off", "lamp_flicker": "off"}
        pipeline = eventide.Pipeline(Live(), seen.append, "small", sequential=True, latency=0, **options)
        pipeline.run()
        self.assertGreater(seen[-1].t, 280_000, "the clock goes on without events")
        gaps = [frame.t for frame in seen if frame.gap_before]
        self.assertEqual([30_000 < t < 60_000 for t in gaps], [True])
        counters = pipeline.counters
        self.assertEqual((counters["gaps"], counters["events"], counters["damaged"]), (1, 2, 0))
        self.assertEqual(counters["frames"], len(seen))

    def test_a_gap_forgets_the_scene_where_that_is_wanted(self):
        before, after = np.array_split(self.events(), 2)

        class Gap:
            width, height, gap_before = 64, 48, False

            def __iter__(self):
                yield before
                self.gap_before = True
                yield after

        def piped(reset_on_gap):
            frames = []
            options = {"sequential": True, "latency": 0, "reset_on_gap": reset_on_gap, **REPEATABLE}
            eventide.Pipeline(Gap(), frames.append, "small", **options).run()
            return {f.t: f.intensity.tobytes() for f in frames}  # a live source may leave out some

        def one_by_one(reset_on_gap):
            reconstructor = self.reconstructor(reset_on_gap=reset_on_gap)
            reconstructor.push(before)
            reconstructor.mark_gap()
            reconstructor.push(after)
            return {f.t: f.intensity.tobytes() for f in reconstructor.frames()}

        for frames in (piped, one_by_one):
            kept, forgotten = frames(False), frames(True)
            others = [t for t in kept.keys() & forgotten.keys() if kept[t] != forgotten[t]]
            self.assertGreater(len(others), 0)
            self.assertGreater(min(others), before["t"][-1] - 10_000)

    def test_a_silence_is_rendered_where_that_is_allowed(self):
        far_apart = np.zeros(2, DTYPE)
        far_apart["t"] = 0, 10**12  # 100 million frames
        for allowed in (False, True):
            seen = []

            def hundred(frame):
                seen.append(frame)
                return len(seen) < 100

            pipeline = eventide.Pipeline(
                [far_apart], hundred, "small", width=64, height=48, allow_silence=allowed, **REPEATABLE
            )
            if allowed:
                pipeline.run()
                self.assertEqual(len(seen), 100)
            else:
                with self.assertRaisesRegex(eventide.InputError, "without events"):
                    pipeline.run()

    def test_events_of_no_sensor_and_no_time_are_counted(self):
        events = np.zeros(5, DTYPE)
        events["t"], events["x"] = [1, 2, 2**62, 4, 5], [0, 64, 0, 0, 65535]
        pipeline = eventide.Pipeline([events], [], "small", width=64, height=48)
        pipeline.run()
        self.assertEqual((pipeline.counters["events"], pipeline.counters["damaged"]), (2, 3))

    def test_what_a_pipeline_reads_nobody_else_reads(self):
        for sequential in (False, True):
            reader, camera = eventide.open(self.recording), eventide.open_camera("sim:demo?size=64x48&speed=max")
            for source in (reader, camera):
                others = [
                    lambda: next(source),
                    lambda: source.read_into(self.reconstructor()),
                    lambda: eventide.Pipeline(source, print, "small").run(),
                ]
                others += [lambda: reader.seek(0)] if source is reader else []
                for other in others:

                    def meddle(frame):
                        self.assertIsNotNone(source.clock)
                        self.assertEqual(source.damaged, 0)
                        with self.assertRaisesRegex(eventide.UsageError, "expected .* found one that a"):
                            other()
                        return False

                    reader.seek(0)
                    eventide.Pipeline(source, meddle, "small", sequential=sequential, **REPEATABLE).run()
            reader.seek(0)
            self.assertGreater(len(next(reader)), 0, "the run is over")

    def test_a_class_of_ones_own_is_what_it_gives(self):
        class Mirrored(eventide.Reader):
            def __next__(self):
                events = super().__next__().copy()
                events["x"] = 63 - events["x"]
                return events

        frames = self.frames_of(Mirrored(self.recording))
        self.assertFalse(np.array_equal(frames, self.frames_of(eventide.open(self.recording))))

    def test_a_sink_that_wants_no_more_ends_a_camera(self):
        camera = eventide.open_camera("sim:demo?size=64x48&speed=1")
        seen = []

        def three(frame):
            seen.append(frame.t)
            return len(seen) < 3

        eventide.Pipeline(camera, [three, lambda frame: None], "small", window="10ms").run()
        self.assertEqual(len(seen), 3)

    def test_a_sink_that_wants_no_more_ends_a_source_that_waits(self):
        comes = threading.Event()
        self.addCleanup(comes.set)

        def some():
            yield self.events()
            comes.wait()

        frames = []
        pipeline = eventide.Pipeline(some(), lambda frame: frames.append(frame) or False, "small", width=64, height=48)
        pipeline.run()
        self.assertEqual(len(frames), 1)

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

    def test_false_ends_a_run_and_so_does_numpys(self):
        for no, ends in ((False, True), (np.False_, True), (None, False), (0, False)):
            seen = []

            def sink(frame):
                seen.append(frame)
                return no if len(seen) == 2 else None

            eventide.Pipeline(eventide.open(self.recording), sink, "small", sequential=True, fps=100).run()
            self.assertEqual(len(seen) == 2, ends, repr(no))

    def test_sinks_are_called_on_the_thread_of_run(self):
        for sequential in (False, True):
            threads = []
            source = eventide.open(self.recording)
            sinks = [lambda frame: threads.append(threading.current_thread())] * 2
            eventide.Pipeline(source, sinks, "small", sequential=sequential).run()
            self.assertEqual(set(threads), {threading.current_thread()})

    def test_what_failed_is_freed(self):
        def full(frame):
            raise OSError("disk")

        def failed(sequential):
            pipeline = eventide.Pipeline(eventide.open(self.recording), full, "small", sequential=sequential)
            try:
                pipeline.run()
            except OSError:
                return weakref.ref(pipeline)

        for sequential in (False, True):
            self.assertIsNone(failed(sequential)())

    def test_what_its_source_and_sink_know_is_freed(self):
        def run(sequential):
            def source():
                yield self.events()[: 1000 + pipeline.counters["frames"]]

            def sink(frame):
                pipeline.stop()

            pipeline = eventide.Pipeline(source(), sink, "small", width=64, height=48, sequential=sequential)
            pipeline.run()
            pipeline.stop()
            with self.assertRaisesRegex(eventide.UsageError, "one run"):
                pipeline.run()
            return weakref.ref(pipeline)

        for sequential in (False, True):
            pipeline = run(sequential)
            gc.collect()
            self.assertIsNone(pipeline())

    def test_one_that_never_ran_is_freed_with_its_owner(self):
        class Owner:
            def __init__(self, source, **options):
                self.pipeline = eventide.Pipeline(source, self.sink, "small", **options)

            def sink(self, frame):
                pass

        class Source(list):
            width, height = 64, 48

        owner = weakref.ref(Owner([self.events()], width=64, height=48))
        source = Source([self.events()])
        source.pipeline = eventide.Pipeline(source, lambda frame: None, "small")
        reader = weakref.ref(Owner(eventide.open(self.recording)))
        knows_it = weakref.ref(source)
        del source
        gc.collect()
        for freed in owner, knows_it, reader:
            self.assertIsNone(freed())

    def test_its_options_are_those_of_the_reconstructor(self):
        def shown(frame):
            return frame.t, frame.intensity.tobytes(), None if frame.sigma is None else frame.sigma.tobytes()

        def frames(options):
            frames = []
            options = {**REPEATABLE, **options}
            pipeline = eventide.Pipeline(
                eventide.open(self.recording), lambda frame: frames.append(shown(frame)), "small", **options
            )
            pipeline.run()
            reader, reconstructor = eventide.open(self.recording), self.reconstructor(**options)
            self.assertEqual(frames, [shown(f) for f in eventide.read_frames(reader, reconstructor)])
            return frames

        hot = self.folder / "hot.txt"
        hot.write_text("".join(f"{x},{y}\n" for x in range(64) for y in range(0, 48, 2)))
        as_they_are = frames({})
        for options in (
            {"window": "auto"},
            {"lookahead": 0},
            {"fps": 50},
            {"size": (32, 24)},
            {"roi": (10, 20, 30, 24)},
            {"sigma": False},
            {"hot_pixels": hot},
            {"noise_filter": "1ms"},
            {"images": False},
            {"self_ensemble": 2},
            {"precision": "bf16"},
        ):
            with self.subTest(options):
                self.assertNotEqual(frames(options), as_they_are)
        for options, words in (
            ({"lamp_flicker": "bananas"}, "bananas"),
            ({"kernels": "bananas"}, "kernels: expected auto, own or onednn, found 'bananas'"),
            ({"threads": -3}, "threads: .* found -3"),
        ):
            for make in (self.reconstructor, lambda **more: self.frames_of(eventide.open(self.recording), **more)):
                with self.assertRaisesRegex(eventide.UsageError, words):
                    make(**options)

    def test_what_cannot_run_is_refused(self):
        with self.assertRaisesRegex(eventide.UsageError, "width"):
            eventide.Pipeline([], print, "small")
        with self.assertRaisesRegex(eventide.UsageError, "speed"):
            eventide.Pipeline([], print, "small", width=4, height=4, speed=3)

    def test_values_of_another_type_are_refused_by_name(self):
        for options, words in [
            ({"fps": True}, "fps: expected int, float or str, found True"),
            ({"window": None}, "window: expected str, found None"),
            ({"lookahead": 1.5}, "lookahead: expected int, found 1.5"),
            ({"size": "64x48"}, "size: expected .*, found '64x48'"),
            ({"roi": (1, 2)}, r"roi: expected .*, found \(1, 2\)"),
            ({"hot_pixels": 5}, "hot_pixels: expected .*, found 5"),
            ({"precision": 32}, "precision: expected str, found 32"),
        ]:
            with self.assertRaisesRegex(TypeError, words):
                eventide.Pipeline([], print, "small", width=64, height=48, **options)

        class Source:
            width, height, clock = 64, "48", "noon"

            def __iter__(self):
                return iter([np.zeros(0, DTYPE)])

        with self.assertRaisesRegex(TypeError, r"events: expected numpy.ndarray, found \(array"):
            eventide.Pipeline(eventide.simulate("demo", (64, 48), 0.1), print, "small").run()
        with self.assertRaisesRegex(TypeError, "height: expected int, found '48'"):
            eventide.Pipeline(Source(), print, "small")
        with self.assertRaisesRegex(TypeError, "clock: expected int, found 'noon'"):
            eventide.Pipeline(Source(), print, "small", height=48).run()


if __name__ == "__main__":
    unittest.main()
