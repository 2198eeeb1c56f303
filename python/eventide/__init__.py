"""Video with uncertainty from event cameras.

    import eventide

    reader = eventide.open("recording.aedat4")
    reconstructor = eventide.Reconstructor("default", reader.width, reader.height, window="auto")
    for frame in eventide.read_frames(reader, reconstructor):
        print(frame.t, frame.intensity.mean(), frame.sigma.mean())

simulate() gives events with the truth they came from, evaluate() says how far a frame is from it.

Times are whole microseconds of the sensor's clock, sizes (width, height) in pixels. Events are
structured arrays with the fields t, x, y and p, on, pol or polarity, in any order and of any width
of whole numbers. Everything that works long lets other threads run. What makes no call fail, as a
camera passed over for the next one or a size that had to be guessed, is logged as a warning by the
logger "eventide".
"""

try:
    from ._eventide import (
        Camera,
        DeviceError,
        Error,
        Frame,
        InputError,
        PerceptualDistance,
        Pipeline,
        Reader,
        Reconstructor,
        Simulation,
        UsageError,
        Writer,
        __version__,
        evaluate,
    )
except ModuleNotFoundError as error:
    if error.name != "eventide._eventide":
        raise
    import pathlib
    import sys

    built = sorted(file.name for file in pathlib.Path(__file__).parent.glob("_eventide.*"))
    raise ImportError(
        f"eventide: expected the Python that {' or '.join(built) or 'a compiled part'} was built for, "
        f"found {sys.version.split()[0]} ({sys.executable})"
    ) from None

__all__ = [
    "Camera",
    "DeviceError",
    "Error",
    "Frame",
    "InputError",
    "PerceptualDistance",
    "Pipeline",
    "Reader",
    "Reconstructor",
    "Simulation",
    "UsageError",
    "Writer",
    "evaluate",
    "open",
    "open_camera",
    "read_frames",
    "simulate",
    "__version__",
]


def _filtered(source, filters):
    for filter in [filters] if isinstance(filters, str) else filters:
        source.add_filter(filter)
    return source


def open(path, format="", width=0, height=0, filters=(), stream=""):
    """Open a recording, in any format that eventide reads; iterate it for arrays of events.

    format, width and height are for what its bytes do not say; stream chooses, of a recording with
    events of several cameras, whose are read, as the warnings name them. filters, as ["flicker"],
    are those of eventide run --filter, one behind the other. Raises InputError, or UsageError for
    a stream or a filter.
    """
    return _filtered(Reader(path, format, width, height, stream), filters)


def open_camera(name, settings="", filters=(), reconnect=False):
    """Open a camera; iterate it for arrays of events.

    name is "davis:", "dvxplorer:", "dvs128:" (the first one that can be used), "davis:SERIAL",
    "v4l2:/dev/video0", "ros2:/TOPIC", "udp://HOST:PORT?size=640x480" or "sim:demo", settings a
    file, filters as in open(); with reconnect an unplugged camera is waited for. Raises
    DeviceError, or UsageError for a name that makes no sense.
    """
    return _filtered(Camera(name, settings, reconnect), filters)


def read_frames(source, reconstructor):
    """Yield the frames of a Reader or Camera: reads on as far as each one needs, to the end."""
    while source.read_into(reconstructor):
        yield from reconstructor.frames()
    reconstructor.finish(source.clock)
    yield from reconstructor.frames()


def simulate(scene="demo", size=(240, 180), seconds=4, **options):
    """Simulate an event camera; iterate it for (events, [(t, truth), ...]) of 10 ms each.

    scene is one of Simulation.scenes(), size (width, height) of the sensor in pixels, seconds the
    length, 0 without end. Options: seed (0: the scene's own), truths_per_second (25), truth_scale
    (1: the sensor's size; s: (width - 1) s + 1 columns, corners stay corners), textures (a folder
    of images). Raises UsageError, InputError.
    """
    return Simulation(scene, size, seconds, **options)
