"""Recordings and cameras in Python."""

import os
import pathlib
import struct
import subprocess
import threading
import unittest
import zlib

import eventide
import numpy as np
from recorded import PROGRAM, RecordedTest


def write_png(path, pixels):
    """[y, x, 3] in RGB or [y, x, 4] in RGBA."""
    height, width, channels = pixels.shape

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, {3: 2, 4: 6}[channels], 0, 0, 0)
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    chunks = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunks)


class Sources(RecordedTest):
    def test_a_recording_tells_its_sensor_its_times_and_its_images(self):
        reader = eventide.open(self.recording)
        self.assertEqual((reader.width, reader.height, reader.format), (64, 48, "aedat4"))
        self.assertIsNone(reader.clock)
        arrays, images = [], []
        for events in reader:
            arrays.append(events)
            images += reader.images
        events = np.concatenate(arrays)
        self.assertEqual(events.dtype.names, ("t", "x", "y", "on"))
        self.assertTrue((np.diff(events["t"]) >= 0).all())
        self.assertEqual(reader.span(), (events["t"][0], events["t"][-1]))
        self.assertEqual(reader.damaged, 0)
        self.assertEqual(images[0][1].shape, (48, 64))
        middle = int(events["t"][len(events) // 2])
        reader.seek(middle)
        np.testing.assert_array_equal(np.concatenate(list(reader)), events[events["t"] >= middle])

    def test_images_without_events_are_those_of_the_next_ones(self):
        file = self.folder / "many_images.aedat4"
        command = [PROGRAM, "simulate", "--size", "346x260", "--seconds", "0.2", "--images-per-second", "100"]
        subprocess.run(command + ["--out", file], check=True, capture_output=True)
        reader, expected = eventide.open(file), []
        reconstructor = eventide.Reconstructor("small", 346, 260)
        while reader.read_into(reconstructor):
            expected += [t for t, _ in reader.images]
        self.assertEqual(len(expected), 21)
        reader, found = eventide.open(file), []
        for _ in reader:
            found += [t for t, _ in reader.images]
        found += [t for t, _ in reader.images]
        self.assertEqual(found, expected)

    def test_images_in_colour_can_be_pushed_as_they_were_read(self):
        for channels, blue_green_red in ((3, [0, 0, 65535]), (4, [0, 0, 65535, 32896])):
            folder = self.folder / f"colour{channels}"
            folder.mkdir()
            red = np.zeros((48, 64, channels), np.uint8)
            red[..., 0], red[..., 3:] = 255, 128
            write_png(folder / "red.png", red)
            (folder / "images.txt").write_text("0.015 red.png\n")
            (folder / "events.txt").write_text("0.001 5 5 1\n0.02 5 5 0\n0.06 5 5 1\n")
            reader, reconstructor = eventide.open(folder, width=64, height=48), self.reconstructor()
            images = []
            for events in reader:
                images += reader.images
                for t, image in reader.images:
                    reconstructor.push_image(t, image)
                reconstructor.push(events)
            self.assertEqual([(t, image.shape) for t, image in images], [(15_000, (48, 64, channels))])
            self.assertEqual(images[0][1][47, 63].tolist(), blue_green_red)
            reconstructor.finish()
            list(reconstructor.frames())
            self.assertEqual(reconstructor.counters["used_images"], 1)

    def test_a_gap_before_data_without_events_is_one_before_the_next_ones(self):
        camera, send = self.udp_camera()
        reconstructor = self.reconstructor()
        outside = [(1, 1000, 1000, 1)]
        for _ in range(400):
            send(outside * 4600)  # the system has no room for all of them
        damaged = -1
        while camera.damaged != damaged:  # until one in which nothing came
            damaged = camera.damaged
            camera.read_into(reconstructor)
        self.assertLess(damaged, 400 * 4600)
        send(outside)

        def follow():  # in a read of its own
            while camera.damaged == damaged:
                pass
            send([(1000 + i, i, i, 1) for i in range(40)])

        following = threading.Thread(target=follow)
        following.start()
        self.assertGreater(len(next(camera)), 0)
        following.join()
        self.assertTrue(camera.gap_before)
        send([(2000 + i, i, i, 1) for i in range(40)])
        self.assertGreater(len(next(camera)), 0)
        self.assertFalse(camera.gap_before)

    def test_arrays_outlive_the_reader(self):
        reader = eventide.open(self.recording)
        first = next(reader)
        kept = first.copy()
        list(reader)
        del reader
        np.testing.assert_array_equal(first, kept)

    def test_what_is_written_comes_back(self):
        events = self.events()
        file = str(self.folder / "written.raw")
        with eventide.Writer(file, 64, 48, format="evt3") as writer:
            writer.write(events[:100])
            writer.write(events[100:])
        np.testing.assert_array_equal(np.concatenate(list(eventide.open(file))), events)
        with self.assertRaises(eventide.UsageError):
            eventide.Writer(file, 64, 48)

    def test_a_recording_that_fails_to_be_written_leaves_nothing(self):
        file = self.folder / "half.aedat4"
        with self.assertRaises(KeyError):
            with eventide.Writer(str(file), 64, 48) as writer:
                writer.write(self.events())
                raise KeyError
        self.assertEqual(list(self.folder.glob("half*")), [])
        for again in (lambda: writer.write(self.events()), writer.finish):
            with self.assertRaisesRegex(eventide.UsageError, "being written, found one that was given up"):
                again()

    def test_what_is_written_has_a_name(self):
        with self.assertRaisesRegex(eventide.UsageError, "expected the name of a file, found none"):
            eventide.Writer("", 64, 48, "text")
        with self.assertRaisesRegex(eventide.UsageError, "expected the name of a file, found none"):
            self.reconstructor().save_state("")

    def test_a_camera_gives_events_until_it_is_stopped(self):
        camera = eventide.open_camera("sim:demo?size=64x48&speed=max")
        reconstructor = self.reconstructor()
        frames = 0
        while camera.read_into(reconstructor):
            frames += len(list(reconstructor.frames()))
            if frames > 10:
                camera.stop()
        self.assertGreater(frames, 10)
        with self.assertRaisesRegex(eventide.UsageError, "kodak"):
            eventide.open_camera("kodak:")
        with self.assertRaisesRegex(eventide.DeviceError, "/dev/none"):
            eventide.open_camera("v4l2:/dev/none")

    def test_filters_stand_behind_a_source(self):
        all = self.events()
        left = np.concatenate(list(eventide.open(self.recording, filters=["polarity:on", "flip:x"])))
        expected = all[all["on"]]
        expected["x"] = 63 - expected["x"]
        np.testing.assert_array_equal(left, expected)
        camera = eventide.open_camera("sim:demo?size=64x48&speed=max", filters="transpose")
        self.assertEqual((camera.width, camera.height), (48, 64))
        reader = eventide.open(self.recording)
        next(reader)
        with self.assertRaisesRegex(eventide.UsageError, "nothing has been read from"):
            reader.add_filter("flip:x")
        with self.assertRaisesRegex(eventide.UsageError, "found 'blur'"):
            eventide.open(self.recording, filters=["blur"])

    def test_no_recording_is_refused_in_words(self):
        with self.assertRaisesRegex(eventide.InputError, "/no/such: cannot open"):
            eventide.open("/no/such")
        with self.assertRaisesRegex(eventide.InputError, "expected the name of a recording, found none"):
            eventide.open("")

    def test_names_of_files_are_any_bytes(self):
        name = os.fsencode(self.folder) + b"/caf\xe9.aedat4"
        events = self.events()
        for path in (name, os.fsdecode(name), pathlib.Path(os.fsdecode(name))):
            with eventide.Writer(path, 64, 48, overwrite=True) as writer:
                writer.write(events)
            np.testing.assert_array_equal(np.concatenate(list(eventide.open(path))), events)
            np.testing.assert_array_equal(np.concatenate(list(eventide.Reader(path))), events)

    def test_errors_name_files_of_any_bytes(self):
        for path in (b"/caf\xe9", os.fsdecode(b"/caf\xe9"), pathlib.Path(os.fsdecode(b"/caf\xe9"))):
            with self.assertRaisesRegex(eventide.InputError, "/caf\ufffd: cannot open"):
                eventide.open(path)
            with self.assertRaisesRegex(eventide.InputError, "/caf\ufffd"):
                eventide.Reconstructor(path, 64, 48)
            with self.assertRaisesRegex(eventide.InputError, "/caf\ufffd"):
                eventide.Pipeline([], print, path, width=64, height=48)
            with self.assertRaisesRegex(eventide.UsageError, "/caf\ufffd"):
                eventide.Reconstructor("small", 64, 48, hot_pixels=path)
            with self.assertRaisesRegex(eventide.InputError, "/caf\ufffd"):
                eventide.simulate(textures=path)

    def test_what_had_to_be_guessed_is_logged(self):
        log = self.folder / "log.txt"
        log.write_text("".join(f"{1e-5 * i:.6f} {i % 64} {i % 48} {i % 2}\n" for i in range(1000)))
        with self.assertLogs("eventide", "WARNING") as logged:
            reader = eventide.open(log)
        self.assertEqual([r.getMessage() for r in logged.records], [f"{log}: {r}" for r in reader.remarks])
        self.assertIn("does not say the sensor's size", logged.output[-1])
        with self.assertRaises(AssertionError), self.assertLogs("eventide"):
            eventide.open(log, width=64, height=48)
        sized = eventide.Reader(log, "text", 70, 50)
        self.assertEqual((sized.width, sized.height, sized.format), (70, 50, "text"))

    def test_of_several_cameras_the_events_of_the_stream_that_is_wanted_are_read(self):
        whole, chosen = eventide.open(self.recording), eventide.open(self.recording, stream="0")
        np.testing.assert_array_equal(
            np.concatenate(list(chosen)), np.concatenate(list(whole))
        )
        with self.assertRaisesRegex(eventide.UsageError, "expected an event stream 7, found 0"):
            eventide.open(self.recording, stream="7")

    def test_a_camera_is_opened_as_one(self):
        for name in ("davis:", "sim:demo"):
            with self.assertRaisesRegex(eventide.UsageError, f"'{name}': expected a recording, .*open_camera"):
                eventide.open(name)

    def test_everything_is_documented(self):
        for kind in (eventide.Reconstructor, eventide.Reader, eventide.Camera, eventide.Writer):
            for name, member in vars(kind).items():
                if not name.startswith("_"):
                    self.assertTrue(member.__doc__, f"{kind.__name__}.{name}")


if __name__ == "__main__":
    unittest.main()
