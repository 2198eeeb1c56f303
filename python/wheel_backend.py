"""What `pip install .` runs: CMake builds and installs the module, the shared library and the models
into a folder, and the folder becomes a wheel. Needs what scripts/install-packages.sh installs and
nothing from elsewhere (PEP 517, PEP 427). Settings: --config-settings build-dir=DIR (kept, for the
next time), --config-settings cmake-args="-DEVENTIDE_ROS2=OFF ...".
"""

import base64
import hashlib
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

SOURCE = pathlib.Path(__file__).resolve().parent.parent


def version():
    text = (SOURCE / "include/eventide/version.h").read_text()
    return ".".join(re.findall(r"^#define EVENTIDE_VERSION_\w+ (\d+)$", text, re.MULTILINE))


def tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"


def install_tree(build, prefix, cmake_args):
    """The package as it lies in site-packages: eventide/ with lib/ and share/ in it."""
    # The interpreter behind a virtual environment, without what pip says of its own: it finds
    # Debian's NumPy.
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
    python = getattr(sys, "_base_executable", sys.executable)
    configure = ["cmake", "-S", SOURCE, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                 "-DEVENTIDE_TESTS=OFF", "-DEVENTIDE_TRAIN=OFF", "-DEVENTIDE_PYTHON=ON",
                 f"-DPython3_EXECUTABLE={python}", "-DEVENTIDE_PYTHON_DIR:STRING=.",
                 "-DCMAKE_INSTALL_LIBDIR=eventide/lib", "-DCMAKE_INSTALL_DATADIR=eventide/share",
                 "-DCMAKE_INSTALL_DOCDIR=eventide/share/doc", *cmake_args]
    for command in [configure, ["cmake", "--build", build, "--target", "eventide_python"],
                    *[["cmake", "--install", build, "--prefix", prefix, "--component", component]
                      for component in ("core", "library", "python")]]:
        subprocess.run(command, check=True, env=environment)
    # A wheel holds no links: of the library only the name that programs load it by.
    for link in [p for p in prefix.rglob("*") if p.is_symlink()]:
        target = link.resolve()
        link.unlink()
        shutil.move(target, link)


def check_tree(prefix):
    """What a user would miss only when he imports it."""
    for needed in ("__init__.py", "_eventide.*.so", "lib/libeventide.so.*",
                   "lib/libeventide-core.so.*",
                   "share/eventide/models/default.safetensors"):
        if not list((prefix / "eventide").glob(needed)):
            raise RuntimeError(f"eventide/{needed}: expected in what CMake installed, found none")


def metadata():
    return (f"Metadata-Version: 2.1\nName: eventide\nVersion: {version()}\n"
            "Summary: Video with uncertainty from event cameras, in real time\n"
            "Requires-Python: >=3.9\nRequires-Dist: numpy\n")


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    name = f"eventide-{version()}.dist-info"
    folder = pathlib.Path(metadata_directory) / name
    folder.mkdir()
    (folder / "METADATA").write_text(metadata())
    return name


def write_wheel(folder, wheel_directory):
    """Everything below `folder`, with the metadata, as a wheel; gives its name."""
    name = f"eventide-{version()}-{tag()}.whl"
    info = f"eventide-{version()}.dist-info"
    files = {str(p.relative_to(folder)): p.read_bytes()
             for p in sorted(folder.rglob("*")) if p.is_file()}
    files[f"{info}/METADATA"] = metadata().encode()
    files[f"{info}/WHEEL"] = ("Wheel-Version: 1.0\nGenerator: eventide\nRoot-Is-Purelib: false\n"
                              f"Tag: {tag()}\n").encode()
    record = ""
    for path, data in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        record += f"{path},sha256={digest},{len(data)}\n"
    files[f"{info}/RECORD"] = (record + f"{info}/RECORD,,\n").encode()
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, data in files.items():
            entry = zipfile.ZipInfo(path)
            entry.external_attr = 0o644 << 16
            wheel.writestr(entry, data, zipfile.ZIP_DEFLATED)
    return name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    settings = config_settings or {}
    with tempfile.TemporaryDirectory() as scratch:
        build = pathlib.Path(settings.get("build-dir", pathlib.Path(scratch) / "build"))
        prefix = pathlib.Path(scratch) / "tree"
        install_tree(build, prefix, shlex.split(settings.get("cmake-args", "")))
        check_tree(prefix)
        return write_wheel(prefix, wheel_directory)


class UnsupportedOperation(Exception):
    """As PEP 517 names it."""


def build_sdist(sdist_directory, config_settings=None):
    raise UnsupportedOperation("eventide is built from its repository; make a wheel of that")
