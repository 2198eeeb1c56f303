"""The reconstructor in Python: frames of `eventide run`, arrays that stay, threads that run."""

import threading
import unittest

import eventide
import numpy as np
from recorded import DTYPE, RecordedTest


class Frames(RecordedTest):
    def test_are_those_of_eventide_run(self):
        expected = self.frames_of_run()
        reader = eventide.open(self.recording)
        reconstructor = self.reconstructor()
        frames = []
        while reader.read_into(reconstructor):
            frames += reconstructor.frames()
        reconstructor.finish(reader.clock)
        frames += reconstructor.frames()
        np.testing.assert_array_equal([[f.intensity, f.sigma] for f in frames], expected)
        self.assertEqual([f.index for f in frames], list(range(len(expected))))
        self.assertEqual(reconstructor.counters["frames"], len(expected))

    def test_are_read_from_a_source_to_its_end(self):
        reader = eventide.open(self.recording)
        frames = [[f.intensity, f.sigma] for f in eventide.read_frames(reader, self.reconstructor())]
        np.testing.assert_array_equal(frames, self.frames_of_run())

    def test_are_the_same_from_arrays(self):
        expected = self.frames_of_run("ignore")
        reader = eventide.open(self.recording)
        reconstructor = self.reconstructor()
        for events in reader:
            reconstructor.push(events, resets=True)
        reconstructor.finish(reader.clock)
        frames = [[f.intensity, f.sigma] for f in reconstructor.frames()]
        np.testing.assert_array_equal(frames, expected)

    def test_are_not_corrected_by_images_that_may_not(self):
        reader = eventide.open(self.recording)
        reconstructor = self.reconstructor(images=False)
        while reader.read_into(reconstructor):
            pass
        reconstructor.finish(reader.clock)
        frames = [[f.intensity, f.sigma] for f in reconstructor.frames()]
        np.testing.assert_array_equal(frames, self.frames_of_run("ignore"))
        self.assertEqual(reconstructor.counters["used_images"], 0)

    def test_are_corrected_by_images_of_ones_own(self):
        still = np.full((48, 64), 200, np.uint8)
        still[10:20, 30:40] = 20
        with_alpha = np.stack(3 * [still] + [np.full_like(still, 255)], axis=2)
        corrected = []
        events = np.zeros(3, [("t", "<i8"), ("x", "<u2"), ("y", "<u2"), ("on", "?")])
        events["t"] = 1000, 20_000, 60_000
        for image in (still, still.astype(np.uint16) * 257, np.stack(3 * [still], axis=2), with_alpha):
            reconstructor = self.reconstructor()
            reconstructor.push(events[:2])
            reconstructor.push_image(15_000, image, exposure=(12_000, 18_000))
            reconstructor.push(events[2:])
            intensity, _ = reconstructor.render(reconstructor.newest())
            np.testing.assert_allclose(intensity, still / 255, atol=0.02)
            corrected.append(intensity)
            self.assertEqual(reconstructor.counters["used_images"], 1)
        np.testing.assert_array_equal(corrected[0], corrected[1])
        widest = np.zeros((1, 4096), np.uint8)
        reconstructor.push_image(70_000, widest)
        wider, pairs = np.zeros((1, 4097), np.uint8), np.stack(2 * [still], axis=2)
        for image in (still.astype(np.float32), still[0], pairs, still[:0], still[:, :0], wider):
            with self.assertRaisesRegex(eventide.UsageError, "expected uint8 or uint16"):
                reconstructor.push_image(70_000, image)
        with self.assertRaisesRegex(eventide.UsageError, "exposure_end not before exposure_begin, found 60000 us"):
            reconstructor.push_image(70_000, still, exposure=(80_000, 60_000))
        with self.assertRaisesRegex(eventide.UsageError, "image: expected an array without a mask"):
            reconstructor.push_image(70_000, np.ma.masked_greater(still, 100))

    def test_outlive_what_made_them(self):
        reconstructor = self.reconstructor()
        reconstructor.push(self.events())
        intensity, sigma = reconstructor.render(reconstructor.newest())
        kept = intensity.copy(), sigma.copy()
        again = reconstructor.render(reconstructor.newest(), size=(32, 24))
        del reconstructor, again
        np.testing.assert_array_equal(intensity, kept[0])
        np.testing.assert_array_equal(sigma, kept[1])

    def test_have_the_size_and_region_asked_for(self):
        reconstructor = self.reconstructor(sigma=False, size=(32, 24))
        reconstructor.push(self.events())
        t = reconstructor.newest()
        self.assertEqual(reconstructor.render(t)[0].shape, (24, 32))
        self.assertIsNone(reconstructor.render(t)[1])
        whole, _ = reconstructor.render(t, size=(100, 80))
        self.assertEqual((whole.shape, whole.dtype), ((80, 100), np.float32))
        part, _ = reconstructor.render(t, size=(100, 80), roi=(10, 20, 30, 40))
        np.testing.assert_array_equal(part, whole[20:60, 10:40])
        of_a_part = self.reconstructor(roi=(1, 2, 10, 8))
        of_a_part.push(self.events())
        self.assertEqual(of_a_part.render(of_a_part.newest())[0].shape, (8, 10))
        self.assertEqual(of_a_part.render(of_a_part.newest(), size=(32, 24))[0].shape, (24, 32))

    def test_come_at_a_rate_that_is_a_number_or_a_text(self):
        def times(fps):
            reconstructor = self.reconstructor(fps=fps)
            reconstructor.push(self.events())
            return [f.t for f in reconstructor.frames()]

        for fps in (100.0, np.int64(100), np.float32(100), "100"):
            self.assertEqual(times(fps), times(100))
        self.assertEqual(times(60000 / 1001), times("60000/1001"))
        self.assertEqual(times(100 / 3), times("100/3"))
        seldom = self.reconstructor(fps=1 / 1001, allow_silence=True)
        far_apart = np.zeros(2, DTYPE)
        far_apart["t"] = 0, 1100 * 10**6
        seldom.push(far_apart)
        self.assertEqual([f.t for f in seldom.frames()][1:], [1001 * 10**6 - 1])
        with self.assertRaisesRegex(eventide.UsageError, "frame rate"):
            self.reconstructor(fps=float("nan"))
        with self.assertRaisesRegex(eventide.UsageError, "frame rate '1e-09'"):
            self.reconstructor(fps=1e-9)
        for fps in (True, None, [30]):
            with self.assertRaisesRegex(TypeError, "fps: expected int, float or str"):
                self.reconstructor(fps=fps)

    def test_wait_for_events(self):
        reconstructor = self.reconstructor()
        self.assertIsNone(reconstructor.next())
        self.assertIsNone(reconstructor.newest())
        events = self.events()
        reconstructor.push(events)
        first = int(events["t"][0])
        self.assertTrue(reconstructor.ready(first))
        self.assertFalse(reconstructor.ready(first + 10_000_000))
        with self.assertRaisesRegex(eventide.UsageError, "not pushed yet"):
            reconstructor.render(first + 10_000_000)
        reconstructor.finish()
        for late in (events, events[:0]):
            with self.assertRaisesRegex(eventide.UsageError, r"reset\(\)"):
                reconstructor.push(late)
        reconstructor.reset()
        reconstructor.push(events)

    def test_go_on_to_the_end_that_is_told(self):
        def count(after):
            reconstructor, events = self.reconstructor(), self.events()
            reconstructor.push(events)
            reconstructor.finish(int(events["t"][-1]) + after)
            return len(list(reconstructor.frames()))

        self.assertEqual(count(100_000), count(0) + 10)

    def test_with_a_state_go_on(self):
        reconstructor = self.reconstructor()
        reconstructor.push(self.events())
        reconstructor.newest()
        file = self.folder / "state.safetensors"
        reconstructor.save_state(file)
        with self.assertRaises(eventide.UsageError):
            reconstructor.save_state(file)
        reconstructor.save_state(file, overwrite=True)
        reconstructor.restore_state(file)
        with self.assertRaisesRegex(eventide.InputError, "none"):
            reconstructor.restore_state(self.folder / "none")

    def test_with_a_state_in_memory_go_on_as_with_one_in_a_file(self):
        reconstructor = self.reconstructor()
        reconstructor.push(self.events())
        reconstructor.newest()
        state = reconstructor.state()
        file = self.folder / "in_a_file.safetensors"
        reconstructor.save_state(file)
        self.assertEqual(state, file.read_bytes())

        def frames(restore):
            it = self.reconstructor()
            restore(it)
            it.push(self.events())
            return [f.intensity for f in it.frames()]

        from_memory = frames(lambda it: it.restore(state))
        np.testing.assert_array_equal(from_memory, frames(lambda it: it.restore_state(file)))
        self.assertFalse(np.array_equal(from_memory, frames(lambda it: None)))
        for held in (bytearray(state), memoryview(state), np.frombuffer(state, np.uint8)):
            np.testing.assert_array_equal(frames(lambda it: it.restore(held)), from_memory)
        with self.assertRaisesRegex(eventide.InputError, "state: "):
            reconstructor.restore(state[:-1])
        with self.assertRaises(TypeError):
            reconstructor.restore("text")
        self.assertEqual(reconstructor.state(), state)

    def test_what_takes_a_reconstructor_says_so(self):
        reader = eventide.open(self.recording)
        with self.assertRaisesRegex(TypeError, r"reconstructor: eventide\._eventide\.Reconstructor\)"):
            reader.read_into("default")

    def test_errors_have_the_library_s_words(self):
        for options, words in [
            ({"window": "5 bananas"}, "5 bananas"),
            ({"lookahead": 7}, "found 7"),
            ({"precision": "f64"}, "precision: expected auto, f32 or bf16, found 'f64'"),
            ({"size": (0, 5)}, r"found \(0, 5\)"),
        ]:
            with self.assertRaisesRegex(eventide.UsageError, words):
                self.reconstructor(**options)
        with self.assertRaisesRegex(eventide.InputError, "'nobody'"):
            eventide.Reconstructor("nobody", 64, 48)
        for t in (1.5, float("nan")):
            with self.assertRaises(TypeError):
                self.reconstructor().render(t)

    def test_counters_tell_each_what_it_is_called(self):
        def at(*times, x=5):
            events = np.zeros(len(times), DTYPE)
            events["t"], events["x"] = times, x
            return events

        reconstructor = self.reconstructor(noise_filter="off", lamp_flicker="off")
        reconstructor.push(at(0))
        reconstructor.advance(100_000)
        reconstructor.newest()
        reconstructor.push(at(50_000))  # late
        reconstructor.push(at(10, 20))  # earlier
        reconstructor.push(at(*[100_000] * 3, x=64))
        reconstructor.push(at(*[2**62] * 4))
        for t in range(45_000, 0, -9_000):
            reconstructor.push(at(t), resets=True)
        frames = len(list(reconstructor.frames()))
        image = np.full((48, 64), 100, np.uint8)
        for t, of_images in ((10**6, []), (1_100_000, [999_000]), (1_200_000, [*range(1000, 7000, 1000), 1_050_000])):
            for of_image in of_images:
                reconstructor.push_image(of_image, image)
            reconstructor.push(at(t))
            frames += len(list(reconstructor.frames()))
        counters = reconstructor.counters
        self.assertGreater(counters.pop("event_windows"), 60)
        expected = {"late": 1, "time_backwards": 2, "off_sensor": 3, "bad_time": 4, "time_resets": 5}
        expected |= {"dropped_images": 6, "used_images": 2, "filtered": 0, "left_out": 0}
        self.assertEqual(counters, expected | {"events": 19, "frames": frames})

    def test_an_image_of_a_part_of_the_sensor_corrects_that_part(self):
        events = np.zeros(3, DTYPE)
        events["t"] = 1000, 20_000, 60_000
        part = np.full((20, 30), 200, np.uint8)
        reconstructor = self.reconstructor(noise_filter="off")
        reconstructor.push(events[:2])
        reconstructor.push_image(15_000, part, at=(8, 24))
        reconstructor.push(events[2:])
        intensity, _ = reconstructor.render(reconstructor.newest())
        np.testing.assert_allclose(intensity[24:44, 8:38], 200 / 255, atol=0.02)
        self.assertLess(intensity[8:24, 38:].mean(), 0.7)

    def test_tell_of_their_event_window(self):
        events = np.zeros(4, DTYPE)
        events["t"] = 1000, 89_000, 90_000, 95_000
        reconstructor = self.reconstructor(noise_filter="off", lamp_flicker="off", window="10ms")
        reconstructor.push(events[:1])
        reconstructor.mark_gap()
        reconstructor.push(events[1:])
        reconstructor.finish()
        frames = list(reconstructor.frames())
        self.assertTrue(all(f.window[0] < f.t <= f.window[1] for f in frames[1:]))
        self.assertTrue(all(f.window[1] - f.window[0] == 10_000 for f in frames[:-1]))
        self.assertEqual(sorted({f.events for f in frames}), [0, 1, 2])
        self.assertEqual({f.window for f in frames if f.gap_before}, {frames[0].window})
        self.assertEqual(
            [f.events == sum(f.window[0] < t <= f.window[1] for t in events["t"]) for f in frames],
            [True] * len(frames),
        )

    def test_threads_share_one_object_and_python_runs_on(self):
        reconstructor = self.reconstructor()
        pieces = np.array_split(self.events(), 20)
        found = []

        def push():
            for piece in pieces:
                reconstructor.push(piece)

        def take():
            while len(found) < 20:
                found.extend(reconstructor.frames())

        threads = [threading.Thread(target=push), threading.Thread(target=take)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual([f.index for f in found], list(range(len(found))))


if __name__ == "__main__":
    unittest.main()
