"""Objects whose __init__ did not run, which Python makes by cls.__new__(cls) and in classes of one's own."""

import inspect
import unittest

import eventide
from eventide import _eventide

CLASSES = [c for _, c in inspect.getmembers(_eventide, inspect.isclass) if not issubclass(c, Exception)]


class Uninitialised(unittest.TestCase):
    def test_what_they_have_is_refused(self):
        self.assertGreaterEqual(len(CLASSES), 9)
        for cls in CLASSES:
            unmade = cls.__new__(cls)
            properties = [name for name, it in inspect.getmembers(cls) if isinstance(it, property)]
            for name in properties:
                with self.subTest(cls.__name__ + "." + name), self.assertRaisesRegex(TypeError, "__init__"):
                    getattr(unmade, name)

    def test_what_they_do_is_refused(self):
        for cls, name, arguments in [
            (eventide.Reader, "__next__", ()),
            (eventide.Reader, "seek", (0,)),
            (eventide.Camera, "stop", ()),
            (eventide.Simulation, "__next__", ()),
            (eventide.Writer, "finish", ()),
            (eventide.Reconstructor, "next", ()),
            (eventide.Reconstructor, "frames", ()),
            (eventide.Pipeline, "run", ()),
        ]:
            with self.subTest(cls.__name__ + "." + name), self.assertRaisesRegex(TypeError, "__init__"):
                getattr(cls.__new__(cls), name)(*arguments)

    def test_they_are_no_argument_either(self):
        unmade = eventide.Reconstructor.__new__(eventide.Reconstructor)
        with self.assertRaisesRegex(TypeError, "__init__"):
            eventide.open_camera("sim:demo?size=32x24").read_into(unmade)
        with self.assertRaisesRegex(TypeError, "__init__"):
            eventide.Pipeline(eventide.Reader.__new__(eventide.Reader), print)

    def test_a_class_of_ones_own_may_not_use_itself_before_it_is_made(self):
        class Early(eventide.Simulation):
            def __init__(self):
                self.early = self.width
                super().__init__("demo", (32, 24), 0.1)

        with self.assertRaisesRegex(TypeError, "__init__"):
            Early()
