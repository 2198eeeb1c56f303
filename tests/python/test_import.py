"""What `import eventide` says where it cannot."""

import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import eventide


class Import(unittest.TestCase):
    def test_another_python_is_told_which_one_is_expected(self):
        with tempfile.TemporaryDirectory() as place:
            package = pathlib.Path(place) / "eventide"
            package.mkdir()
            shutil.copy(eventide.__file__, package)
            (package / "_eventide.cpython-30-x86_64-linux-gnu.so").touch()
            command = [sys.executable, "-c", "import eventide"]
            said = subprocess.run(command, capture_output=True, text=True, env={"PYTHONPATH": place}).stderr
        self.assertIn("expected the Python that _eventide.cpython-30-x86_64-linux-gnu.so was built for", said)
        self.assertIn(f", found {sys.version.split()[0]} ({sys.executable})", said)


if __name__ == "__main__":
    unittest.main()
