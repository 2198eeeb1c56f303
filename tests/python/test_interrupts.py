"""Ctrl-C ends what would go on for ever, inside of the library too, and what was interrupted goes on."""

import collections
import contextlib
import errno
import fcntl
import functools
import itertools
import operator
import os
import signal
import sys
import tempfile
import termios
import threading
import unittest

import eventide
import numpy as np
from recorded import DTYPE, RecordedTest

ENDLESS_CAMERA = "sim:demo?size=64x48&speed=max"


def consume(iterator):
    """No line of Python runs between two items, in which the interpreter could see the signal."""
    collections.deque(iterator, maxlen=0)


def bytes_in(pipe):
    waiting = bytearray(4)
    fcntl.ioctl(pipe, termios.FIONREAD, waiting)
    return int.from_bytes(waiting, sys.byteorder)


class Interrupts(RecordedTest):
    def interrupt(self, loop, has_begun):
        """loop() has no end; the signal comes from another thread once has_begun()."""
        ended = threading.Event()

        def send():
            while not has_begun():
                if ended.is_set():
                    return
            signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)

        sender = threading.Thread(target=send)
        sender.start()
        try:
            with self.assertRaises(KeyboardInterrupt):
                loop()
        finally:
            ended.set()
            sender.join()

    @contextlib.contextmanager
    def pipe(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "pipe")
            os.mkfifo(path)
            yield path

    def test_frames_end(self):
        reconstructor = self.reconstructor(allow_silence=True)
        far_apart = np.zeros(2, DTYPE)
        far_apart["t"] = 0, 10**12  # 100 million frames
        reconstructor.push(far_apart)
        reconstructor.finish()
        self.interrupt(lambda: consume(reconstructor.frames()), lambda: reconstructor.counters["frames"] > 100)
        self.assertIsNotNone(reconstructor.next(), "the next frame comes after an interruption")

    def test_a_push_of_many_events_ends_and_what_follows_goes_on(self):
        reconstructor = self.reconstructor(window="50ms")
        events = np.zeros(4_000_000, DTYPE)
        events["t"] = np.arange(len(events))
        self.interrupt(lambda: reconstructor.push(events), lambda: reconstructor.counters["events"] > 0)
        pushed = reconstructor.counters["events"]
        self.assertLess(pushed, len(events))
        reconstructor.push(events[pushed:])
        counters = reconstructor.counters
        self.assertEqual((counters["events"], counters["time_backwards"]), (len(events), 0))

    def test_looking_for_the_span_of_a_long_recording_ends(self):
        path = self.folder / "long.npy"
        events = np.zeros(2_000_000, DTYPE)
        events["t"] = np.arange(len(events))
        events["x"][0], events["y"][0] = 63, 47
        np.save(path, events)
        reader = eventide.open(path, width=64, height=48)
        begun, spans = [], []
        span_of = operator.methodcaller("span")
        self.interrupt(lambda: begun.append(1) or spans.extend(map(span_of, [reader])), lambda: begun)
        self.assertEqual(spans, [])
        self.assertEqual(reader.span(), (0, len(events) - 1))

    def test_a_camera_ends(self):
        camera = eventide.open_camera(ENDLESS_CAMERA)
        self.interrupt(lambda: consume(camera), lambda: camera.clock is not None)
        self.assertGreater(len(next(camera)), 0)

    def test_a_camera_that_is_read_into_a_reconstructor_ends(self):
        camera, reconstructor = eventide.open_camera(ENDLESS_CAMERA), self.reconstructor()
        reads = iter(functools.partial(camera.read_into, reconstructor), False)
        self.interrupt(lambda: consume(reads), lambda: reconstructor.counters["events"] > 1000)
        self.assertTrue(camera.read_into(reconstructor))

    def test_waiting_for_the_first_bytes_of_a_pipe_ends(self):
        with self.pipe() as path:
            writing = []

            def is_opened():  # by a reader, which only eventide is
                try:
                    writing.append(os.open(path, os.O_WRONLY | os.O_NONBLOCK))
                except OSError as error:
                    self.assertEqual(error.errno, errno.ENXIO)
                return len(writing) > 0

            self.interrupt(lambda: eventide.open(path), is_opened)
            os.close(writing[0])

    def test_waiting_for_more_of_a_pipe_ends_and_goes_on(self):
        with self.pipe() as path:
            keeps = os.open(path, os.O_RDWR)
            os.write(keeps, b"64 48\n0.1 1 2 1\n0.2 3 4 0\n0.3 5 6 1\n")
            reader = eventide.open(path)

            self.assertEqual(bytes_in(keeps), 0)
            os.write(keeps, b"0.4 7 8 1\n")
            self.interrupt(lambda: consume(reader), lambda: bytes_in(keeps) == 0)
            os.write(keeps, b"0.43 7 8 0\n0.45 7 8 1\n")
            self.assertGreater(next(reader)["t"][-1], 300_000)
            os.close(keeps)

    def test_waiting_for_the_reader_of_a_pipe_ends(self):
        with self.pipe() as path:
            begun = []
            self.interrupt(lambda: begun.append(1) or eventide.Writer(path, 64, 48, "text"), lambda: begun)

    def test_waiting_for_a_slow_reader_of_a_pipe_ends(self):
        with self.pipe() as path:
            keeps = os.open(path, os.O_RDWR)
            writer = eventide.Writer(path, 64, 48, "text")
            events = np.zeros(100_000, DTYPE)
            self.interrupt(lambda: writer.write(events), lambda: bytes_in(keeps) > 0)
            os.close(keeps)

    def handle(self, handler):
        self.addCleanup(signal.signal, signal.SIGINT, signal.signal(signal.SIGINT, handler))

    def test_the_handler_of_a_signal_may_ask_what_is_being_read_for_its_clock(self):
        with self.pipe() as path:
            keeps = os.open(path, os.O_RDWR)
            os.write(keeps, b"64 48\n0.1 1 2 1\n0.2 3 4 0\n0.3 5 6 1\n")
            reader = eventide.open(path)
            told = []

            def ask(*_):
                told.append((reader.clock, reader.damaged))
                raise KeyboardInterrupt

            self.handle(ask)
            os.write(keeps, b"0.4 7 8 1\n")
            self.interrupt(lambda: consume(reader), lambda: bytes_in(keeps) == 0)
            self.assertEqual([damaged for _, damaged in told], [0])
            os.close(keeps)

    def test_the_handler_of_a_signal_may_not_write_into_what_is_being_written(self):
        with self.pipe() as path:
            keeps = os.open(path, os.O_RDWR)
            writer = eventide.Writer(path, 64, 48, "text")
            events = np.zeros(100_000, DTYPE)

            def meddle(*_):
                for again in (lambda: writer.write(events), writer.finish):
                    with self.assertRaisesRegex(eventide.UsageError, "one call at a time, found .* within another"):
                        again()
                raise KeyboardInterrupt

            self.handle(meddle)
            self.interrupt(lambda: writer.write(events), lambda: bytes_in(keeps) > 0)
            os.close(keeps)

    def test_a_simulation_ends(self):
        simulation = eventide.simulate("demo", size=(32, 24), seconds=1e6)
        self.interrupt(lambda: consume(simulation), lambda: simulation.clock > 100_000)
        events, _ = next(simulation)
        self.assertEqual(events.dtype.names, DTYPE.names)

    def test_a_pipeline_ends(self):
        for sequential in (False, True):
            camera = eventide.open_camera(ENDLESS_CAMERA)
            pipeline = eventide.Pipeline(camera, lambda frame: None, "small", window="10ms", sequential=sequential)
            self.interrupt(pipeline.run, lambda: pipeline.counters["frames"] > 3)

    def test_no_sink_is_called_any_more(self):
        interrupted, late = [], []

        def interrupt(*_):
            interrupted.append(True)
            raise KeyboardInterrupt

        self.handle(interrupt)
        camera = eventide.open_camera(ENDLESS_CAMERA)
        pipeline = eventide.Pipeline(camera, lambda frame: late.extend(interrupted), "small", window="10ms")
        self.interrupt(pipeline.run, lambda: pipeline.counters["frames"] > 3)
        self.assertEqual(late, [])

    def test_an_interruption_comes_before_what_its_source_raises_then(self):
        waits, stopped = threading.Event(), threading.Event()

        class Unplugged:
            width, height = 64, 48

            def __iter__(self):
                waits.set()
                stopped.wait()
                raise OSError("cable")
                yield

            def stop(self):
                stopped.set()

        pipeline = eventide.Pipeline(Unplugged(), [], "small")
        self.interrupt(pipeline.run, waits.is_set)

    def test_a_pipeline_ends_in_which_no_line_of_python_runs(self):
        for sequential in (False, True):
            for sinks in ([], collections.deque(maxlen=1).append):
                for source in (itertools.repeat(np.zeros(0, DTYPE)), eventide.open_camera(ENDLESS_CAMERA)):
                    with self.subTest((sequential, sinks, source)):
                        pipeline = eventide.Pipeline(source, sinks, "small", width=64, height=48, sequential=sequential)
                        self.interrupt(pipeline.run, lambda: pipeline.counters["batches"] > 3)

    def test_a_pipeline_ends_whose_source_waits_for_what_never_comes(self):
        waits, comes = threading.Event(), threading.Event()
        self.addCleanup(comes.set)

        def nothing():
            waits.set()
            comes.wait()
            yield np.zeros(0, DTYPE)

        pipeline = eventide.Pipeline(nothing(), [], "small", width=64, height=48)
        self.interrupt(pipeline.run, waits.is_set)

    def test_a_source_that_asks_again_and_again_is_ended_with_its_pipeline(self):
        asks, ended = threading.Event(), threading.Event()

        def nothing():
            try:
                while True:
                    asks.set()
                yield np.zeros(0, DTYPE)
            finally:
                ended.set()

        pipeline = eventide.Pipeline(nothing(), [], "small", width=64, height=48)
        self.interrupt(pipeline.run, asks.is_set)
        self.assertTrue(ended.wait(100))


if __name__ == "__main__":
    unittest.main()
