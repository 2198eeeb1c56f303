#!/usr/bin/python3
"""Whether apps/train/alone names all sources that the trainer needs, and no library beyond those
that its CMakeLists.txt says: by the objects of preset dev, so in seconds where building takes ten
minutes. They are linked with libtorch and zlib alone, and their headers are looked through."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

if sys.argv[1:]:
    asked = sys.argv[1:] in (["-h"], ["--help"])
    print(f"scripts/check-trainer-alone.py\n{__doc__}", file=sys.stdout if asked else sys.stderr)
    sys.exit(0 if asked else 2)
os.chdir(pathlib.Path(__file__).resolve().parent.parent)
DEV, ALONE = pathlib.Path("build/dev"), pathlib.Path("build/alone")
# Folders below /usr/include: the compiler's and the C library's, then what the build asks for.
ALLOWED = {"c++", "x86_64-linux-gnu", "linux", "asm-generic", "torch", "ATen", "c10", "caffe2",
           "gflags", "glog", "nlohmann", "toml++"}  # the first two: Debian's libtorch


def commands(build):
    return json.loads((build / "compile_commands.json").read_text())


def objects():
    """Of each source of the trainer's own build the object that preset dev made."""
    subprocess.run(["cmake", "-S", "apps/train/alone", "-B", ALONE, "-G", "Ninja",
                    "-DTORCH_ROOT=/usr", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON"],
                   check=True, stdout=subprocess.DEVNULL)
    built = {}
    for command in commands(DEV):
        words = command["command"].split()
        built.setdefault(command["file"], words[words.index("-o") + 1])
    sources = [c["file"] for c in commands(ALONE) if "cmake_pch" not in c["file"]]
    unknown = [source for source in sources if source not in built]
    if unknown:
        sys.exit(f"{unknown[0]}: expected a source of preset dev too, found none")
    return [built[source] for source in sources]


def link(files):
    with tempfile.TemporaryDirectory() as place:
        program = f"{place}/eventide-train"
        subprocess.run(["c++", "-o", program, *files, "-Wl,--no-as-needed", "-ltorch",
                        "-ltorch_cpu", "-lc10", "-lz", "-ldl", "-pthread"], cwd=DEV, check=True)
        subprocess.run([program, "--help"], check=True, stdout=subprocess.DEVNULL)


def foreign_headers(files):
    listed = subprocess.run(["ninja", "-C", DEV, "-t", "deps", *files], check=True,
                            capture_output=True, text=True).stdout
    for line in listed.splitlines():
        folders = pathlib.PurePath(line.strip()).parts[:-1]
        if folders[:3] == ("/", "usr", "include") and len(folders) > 3:
            if folders[3] not in ALLOWED:
                yield line.strip()


found = objects()
link(found)
foreign = sorted(set(foreign_headers(found)))
if foreign:
    sys.exit(f"apps/train/alone: expected no header of another library, found {foreign[0]}")
print(f"the trainer alone: {len(found)} sources, linked with libtorch and zlib")
