"""Events of any program's arrays: fields by name, whatever their order and width."""

import pathlib
import resource
import unittest

import eventide
import numpy as np
from recorded import DTYPE, RecordedTest

# As other programs lay out their events.
LAYOUTS = {
    "metavision": [("x", "<u2"), ("y", "<u2"), ("p", "<i2"), ("t", "<i8")],
    "dv": {
        "names": ["timestamp", "x", "y", "polarity"],
        "formats": ["<i8", "<i2", "<i2", "i1"],
        "offsets": [0, 8, 10, 12],
        "itemsize": 16,
    },
    "tonic": [("x", "<i8"), ("y", "<i8"), ("t", "<i8"), ("p", "<i8")],
    "expelliarmus": [("t", "<i8"), ("x", "<i2"), ("y", "<i2"), ("p", "u1")],
    "faery": [("t", "<u8"), ("x", "<u2"), ("y", "<u2"), ("on", "?")],
    "big endian": [("t", ">u4"), ("y", ">u4"), ("x", ">u4"), ("pol", ">i4")],
}


def in_layout(events, layout):
    dtype = np.dtype(layout)
    out = np.zeros(len(events), dtype)
    for name in dtype.names:
        first = name[0]
        source = {"t": "t", "x": "x", "y": "y", "p": "on", "o": "on"}[first]
        out[name] = events[source]
    return out


class Arrays(RecordedTest):
    def frames(self, events):
        reconstructor = self.reconstructor()
        reconstructor.push(events)
        reconstructor.finish()
        return np.array([f.intensity for f in reconstructor.frames()])

    def test_every_layout_gives_the_same_frames(self):
        events = self.events()
        expected = self.frames(events)
        self.assertGreater(len(expected), 25)
        for name, layout in LAYOUTS.items():
            with self.subTest(name):
                np.testing.assert_array_equal(self.frames(in_layout(events, layout)), expected)

    def test_polarity_of_minus_one_is_darker(self):
        events = in_layout(self.events(), LAYOUTS["metavision"])
        expected = self.frames(events)
        events["p"] = np.where(events["p"] > 0, 1, -1)
        np.testing.assert_array_equal(self.frames(events), expected)

    def test_every_second_event_of_an_array_is_no_copy_of_the_users(self):
        events = self.events()
        np.testing.assert_array_equal(self.frames(events[::2]), self.frames(events[::2].copy()))

    def test_what_makes_no_sense_is_counted(self):
        events = np.zeros(5, [("t", "<i8"), ("x", "<i4"), ("y", "<i4"), ("p", "?")])
        events["t"] = [10, 20, 15, 30, 2**62]
        events["x"] = [0, 3 - 65536, 0, 65536 + 3, 0]
        reconstructor = self.reconstructor()
        reconstructor.push(events)
        reconstructor.push(events[:0])
        counters = reconstructor.counters
        self.assertEqual(counters["events"], 5)
        self.assertEqual(counters["off_sensor"], 2)
        self.assertEqual(counters["bad_time"], 1)
        self.assertEqual(counters["time_backwards"], 0, "the one at 20 was off the sensor")

    def test_times_that_64_bits_with_a_sign_do_not_hold_are_no_times(self):
        for wide in ("<u8", ">u8"):
            events = np.zeros(4, [("t", wide), ("x", wide), ("y", "u1"), ("p", wide)])
            events["t"] = [2**64 - 1, 10, 2**63, 20]
            events["x"][1] = 2**64 - 1
            reconstructor = self.reconstructor()
            reconstructor.push(events)
            counters = reconstructor.counters
            self.assertEqual(counters["bad_time"], 2)
            self.assertEqual(counters["off_sensor"], 1)
            self.assertEqual(counters["time_backwards"], 0)

    def test_more_than_memory_has_room_for_is_refused_and_what_follows_goes_on(self):
        few = np.zeros(1, [("t", "<u8"), ("x", "<u2"), ("y", "<u2"), ("p", "?")])
        writer = eventide.Writer(self.folder / "few.aedat4", 64, 48)
        held = int(pathlib.Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        soft, hard = resource.getrlimit(resource.RLIMIT_AS)
        resource.setrlimit(resource.RLIMIT_AS, (held + 2**28, hard))
        try:
            with self.assertRaises(MemoryError):
                writer.write(np.broadcast_to(few, 10**8))
        finally:
            resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
        writer.write(few)
        writer.finish()

    def test_what_are_no_events_is_refused_in_words(self):
        reconstructor = self.reconstructor()
        good = np.zeros(3, DTYPE)
        for bad, words in [
            (np.zeros(3), "structured array"),
            (np.zeros(3, [("t", "i8"), ("x", "i2"), ("y", "i2")]), "p, on, pol, polarity"),
            (np.zeros(3, [("t", "f8"), ("x", "i2"), ("y", "i2"), ("p", "?")]), "'t'.*float64"),
            (np.zeros((3, 2), DTYPE), "one dimension"),
            (np.ma.zeros(3, DTYPE), "events: expected an array without a mask"),
            (np.zeros(3, [("t", "i8"), ("x", "i2", (2,)), ("y", "i2"), ("p", "?")]), "'x': expected one number"),
            (np.zeros(3, [("t", "i8", (0,)), ("x", "i2"), ("y", "i2"), ("p", "?")]), "'t': expected one number"),
        ]:
            with self.assertRaisesRegex(eventide.UsageError, words):
                reconstructor.push(bad)
        self.assertTrue(issubclass(eventide.UsageError, ValueError))
        reconstructor.push(good)


if __name__ == "__main__":
    unittest.main()
