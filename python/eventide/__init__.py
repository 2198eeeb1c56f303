"""Video with uncertainty from event cameras.

    import eventide

    reader = eventide.open("recording.aedat4")
    reconstructor = eventide.Reconstructor("default", reader.width, reader.height)
    for events in reader:
        reconstructor.push(events)
        for frame in reconstructor.frames():
            print(frame.t, frame.intensity.mean(), frame.sigma.mean())

simulate() gives events with the truth they came from, evaluate() says how far a frame is from it.

Times are whole microseconds of the sensor's clock, sizes (width, height) in pixels. Events are
structured arrays with the fields t, x, y and p, on, pol or polarity, in any order and of any width
of whole numbers. Everything that works long lets other threads run.
"""

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
    "simulate",
    "__version__",
]


def open(path, format="", width=0, height=0):
    """Open a recording, in any format that eventide reads; iterate it for arrays of events.

    format, width and height are for what its bytes do not say. Raises InputError.
    """
    return Reader(path, format, width, height)


def open_camera(name, settings=""):
    """Open a camera; iterate it for arrays of events.

    name is "davis:", "dvxplorer:", "dvs128:" (the first one found), "davis:SERIAL",
    "v4l2:/dev/video0", "ros2:/TOPIC", "udp://HOST:PORT?size=640x480" or "sim:demo", settings a
    file. Raises DeviceError, or UsageError for a name that makes no sense.
    """
    return Camera(name, settings)


def simulate(scene="demo", size=(240, 180), seconds=4, **options):
    """Simulate an event camera; iterate it for (events, [(t, truth), ...]) of 10 ms each.

    scene is one of Simulation.scenes(), size (width, height) of the sensor in pixels, seconds the
    length, 0 without end. Options: seed (0: the scene's own), truths_per_second (25), truth_scale
    (1), textures (a folder of images). Raises UsageError, InputError.
    """
    return Simulation(scene, size, seconds, **options)
