"""Scenes with their truth, and how far frames are from it, in Python."""

import pathlib
import subprocess
import unittest

import eventide
import numpy as np
from recorded import PROGRAM, RecordedTest


class Simulations(RecordedTest):
    def test_events_are_those_of_the_program(self):
        arrays, truths = [], []
        for events, images in eventide.simulate("demo", size=(64, 48), seconds=0.3):
            arrays.append(events)
            truths += images
        np.testing.assert_array_equal(np.concatenate(arrays), self.events())
        self.assertEqual([t for t, _ in truths], list(range(0, 300_001, 40_000)))
        self.assertTrue(all(i.shape == (48, 64) and 0 <= i.min() and i.max() <= 1 for _, i in truths))

    def test_truth_is_finer_than_the_sensor_where_asked(self):
        simulation = eventide.simulate(size=(32, 24), seconds=0.02, truth_scale=2, truths_per_second=100)
        shapes = {image.shape for _, images in simulation for _, image in images}
        self.assertEqual(shapes, {(47, 63)})
        self.assertEqual(simulation.clock, 20_000)

    def test_another_seed_is_another_scene(self):
        def events(seed):
            return np.concatenate([e for e, _ in eventide.simulate(size=(32, 24), seconds=0.1, seed=seed)])

        np.testing.assert_array_equal(events(5), events(5))
        self.assertFalse(np.array_equal(events(5), events(6)))

    def test_what_makes_no_sense_is_refused_by_name(self):
        self.assertIn("demo", eventide.Simulation.scenes())
        with self.assertRaisesRegex(eventide.UsageError, "nowhere"):
            eventide.simulate("nowhere")
        with self.assertRaisesRegex(eventide.UsageError, "width"):
            eventide.simulate(size=(1, 24))
        with self.assertRaisesRegex(eventide.UsageError, "seconds"):
            eventide.simulate(seconds=float("inf"))
        with self.assertRaises(eventide.InputError):
            eventide.simulate(textures=self.folder / "missing")

    def test_truths_come_as_often_as_asked(self):
        for rate in (50, 200):
            simulation = eventide.simulate(size=(32, 24), seconds=0.1, truths_per_second=rate)
            times = [t for _, truths in simulation for t, _ in truths]
            self.assertEqual(set(np.diff(times)), {1e6 / rate})


class Evaluation(RecordedTest):
    def test_a_frame_is_judged_as_the_program_judges_it(self):
        rng = np.random.default_rng(1)
        truth = rng.random((40, 50), np.float32)
        same = eventide.evaluate(truth, truth)
        self.assertEqual((same["mse"], same["picp80"]), (0, None))
        self.assertAlmostEqual(same["ssim"], 1)
        darker = eventide.evaluate(truth * 0.5 + 0.1, truth)
        self.assertAlmostEqual(darker["mse"], float(np.mean((0.5 * truth - 0.1) ** 2)), 6)
        self.assertAlmostEqual(darker["affine_mse"], 0, 6)
        noise = rng.normal(0, 0.05, truth.shape).astype(np.float32)
        shown = np.clip(truth * 0.5 + 0.25 + noise, 0, 1)
        right = eventide.evaluate(shown, truth * 0.5 + 0.25, np.full(truth.shape, 0.05, np.float32))
        self.assertAlmostEqual(right["picp80"], 0.8, delta=0.03)
        self.assertAlmostEqual(right["log_likelihood"], -0.5 * np.log(2 * np.pi * 0.05**2) - 0.5, delta=0.05)

    def test_perceptual_distance_wants_its_weights(self):
        with self.assertRaisesRegex(eventide.InputError, "missing"):
            eventide.PerceptualDistance(self.folder / "missing")
        self.assertIsNone(eventide.evaluate(np.zeros((20, 20)), np.zeros((20, 20)))["lpips"])

    def test_perceptual_distance_is_one_of_the_measures(self):
        weights = pathlib.Path(__file__).parents[2] / "../shared/data/perceptual/lpips_squeeze_v0.1.npz"
        if not weights.exists():
            self.skipTest(f"no LPIPS weights: {weights}")
        lpips = eventide.PerceptualDistance(weights)
        self.assertEqual(lpips.name, "LPIPS-Squeeze")
        truth = np.random.default_rng(1).random((40, 50), np.float32)
        self.assertEqual(lpips.between(truth, truth), 0)
        self.assertGreater(lpips.between(truth / 4, truth), 0.05)
        self.assertEqual(eventide.evaluate(truth / 4, truth, lpips=lpips)["lpips"], lpips.between(truth / 4, truth))
        with self.assertRaisesRegex(eventide.UsageError, "LPIPS, second image: expected finite numbers, found nan"):
            lpips.between(truth, np.full_like(truth, np.nan))
        with self.assertRaisesRegex(eventide.UsageError, "b: expected floats, 0 black to 1 white, found uint8"):
            lpips.between(truth, np.zeros((40, 50), np.uint8))

    def test_planes_of_other_shapes_are_refused(self):
        plane, wide = np.zeros((20, 20)), np.zeros((20, 21))
        for wrong, words in [
            (wide, "truth: expected the size of intensity, 20x20, found 21x20"),
            (np.zeros(20), r"truth: expected an array \[y, x\], found 1 dimensions"),
            (np.zeros((20, 20, 3)), r"truth: expected an array \[y, x\], found 3 dimensions"),
        ]:
            with self.assertRaisesRegex(eventide.UsageError, words):
                eventide.evaluate(plane, wrong)
        with self.assertRaisesRegex(eventide.UsageError, "sigma: expected the size of intensity, 20x20, found 21x20"):
            eventide.evaluate(plane, plane, wide)
        for shape, words in (((5, 5), "at least 11x11, found 5x5"), ((0, 5), "expected pixels, found 5x0")):
            with self.assertRaisesRegex(eventide.UsageError, words):
                eventide.evaluate(np.zeros(shape), np.zeros(shape))

    def test_numbers_that_are_no_brightness_are_refused(self):
        plane = np.full((20, 20), 0.5)
        for kind in (np.uint8, np.int64, complex, object, "U3", "M8[us]", [("grey", "f4")]):
            other = np.zeros((20, 20), kind)
            with self.assertRaisesRegex(eventide.UsageError, "intensity: expected floats, 0 black to 1 white, found"):
                eventide.evaluate(other, plane)
            with self.assertRaisesRegex(eventide.UsageError, "truth: expected floats, 0 black to 1 white, found"):
                eventide.evaluate(plane, other)
        with self.assertRaisesRegex(eventide.UsageError, "truth: expected an array without a mask"):
            eventide.evaluate(plane, np.ma.masked_greater(plane, 0.4))
        for kind in (bool, np.float16, ">f8", np.longdouble):
            self.assertEqual(eventide.evaluate(plane.astype(kind), plane.astype(kind))["mse"], 0)
        for number in (np.nan, np.inf, -np.inf):
            broken = plane.copy()
            broken[3, 4] = number
            for name, planes in (
                ("intensity", (broken, plane)),
                ("truth", (plane, broken)),
                ("sigma", (plane, plane, broken)),
            ):
                with self.assertRaisesRegex(eventide.UsageError, f"{name}: expected finite numbers, found -?(nan|inf)"):
                    eventide.evaluate(*planes)

    def test_a_simulation_feeds_a_reconstructor(self):
        reconstructor = eventide.Reconstructor("small", 64, 48)
        scores, waiting = [], []
        for events, truths in eventide.simulate(size=(64, 48), seconds=0.3):
            reconstructor.push(events)
            waiting += truths
            for t, truth in [w for w in waiting if reconstructor.ready(w[0])]:
                intensity, sigma = reconstructor.render(t)
                scores.append(eventide.evaluate(intensity, truth, sigma))
            waiting = [w for w in waiting if w[0] > (reconstructor.newest() or 0)]
        self.assertGreater(len(scores), 4)
        self.assertLess(scores[-1]["mse"], 0.2)


if __name__ == "__main__":
    unittest.main()
