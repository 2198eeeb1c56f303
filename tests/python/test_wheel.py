"""The wheel that `pip install .` makes: complete, and nothing beside it. Building it takes minutes
(scripts/check.sh wheel); here a folder stands for what CMake installs."""

import pathlib
import sys
import tempfile
import unittest
import zipfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "python"))
import wheel_backend


class Wheel(unittest.TestCase):
    def test_it_holds_the_folder_and_a_record_of_it(self):
        with tempfile.TemporaryDirectory() as place:
            tree = pathlib.Path(place) / "tree"
            (tree / "eventide/lib").mkdir(parents=True)
            (tree / "eventide/__init__.py").write_text("x = 1\n")
            (tree / "eventide/lib/libeventide.so.1").write_bytes(b"\x7fELF")
            name = wheel_backend.write_wheel(tree, place)
            self.assertRegex(name, r"^eventide-\d+\.\d+\.\d+-cp3\d+-cp3\d+-linux_\w+\.whl$")
            with zipfile.ZipFile(pathlib.Path(place) / name) as wheel:
                files = set(wheel.namelist())
                record = wheel.read(f"eventide-{wheel_backend.version()}.dist-info/RECORD").decode()
            self.assertEqual({line.split(",")[0] for line in record.splitlines()}, files)
            self.assertIn("eventide/lib/libeventide.so.1", files)
            self.assertIn("eventide/__init__.py,sha256=", record)

    def test_a_folder_without_the_module_is_no_wheel(self):
        with tempfile.TemporaryDirectory() as place:
            tree = pathlib.Path(place) / "tree"
            (tree / "eventide").mkdir(parents=True)
            with self.assertRaisesRegex(RuntimeError, "__init__.py"):
                wheel_backend.check_tree(tree)


if __name__ == "__main__":
    unittest.main()
