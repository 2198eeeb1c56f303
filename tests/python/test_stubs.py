"""The stubs for editors and type checkers say what the module has."""

import ast
import pathlib
import re
import unittest

import eventide

STUBS = ast.parse((pathlib.Path(eventide.__file__).parent / "__init__.pyi").read_text())
SPECIAL = {"__iter__", "__next__", "__enter__", "__exit__"}


def members(cls):
    return {name for name in vars(cls) if not name.startswith("_") or name in SPECIAL}


def parameters(function):
    """Names, as Python or the first line of the documentation has them."""
    code = getattr(function, "__code__", None)
    if code is not None:
        return set(code.co_varnames[: code.co_argcount])
    return set(re.findall(r"[(,] ?(\w+): ", function.__doc__.splitlines()[0])) - {"self"}


def stub_parameters(function):
    arguments = function.args
    return {argument.arg for argument in arguments.args + arguments.kwonlyargs} - {"self"}


class Stubs(unittest.TestCase):
    def test_have_every_name(self):
        names = {n.name for n in STUBS.body if isinstance(n, (ast.ClassDef, ast.FunctionDef))}
        self.assertEqual(names | {"__version__"}, set(eventide.__all__))

    def test_have_every_member_of_a_class(self):
        for stub in (n for n in STUBS.body if isinstance(n, ast.ClassDef)):
            with self.subTest(stub.name):
                said = {m.name for m in stub.body if isinstance(m, ast.FunctionDef)} - {"__init__"}
                self.assertEqual(said, members(getattr(eventide, stub.name)))

    def test_have_every_parameter(self):
        functions = [(eventide, n) for n in STUBS.body if isinstance(n, ast.FunctionDef)]
        for stub in (n for n in STUBS.body if isinstance(n, ast.ClassDef)):
            methods = (m for m in stub.body if isinstance(m, ast.FunctionDef) and not m.decorator_list)
            functions += [(getattr(eventide, stub.name), m) for m in methods if m.name not in SPECIAL]
        self.assertGreater(len(functions), 30)
        for owner, stub in functions:
            with self.subTest(f"{owner.__name__}.{stub.name}"):
                self.assertEqual(stub_parameters(stub), parameters(getattr(owner, stub.name)))


if __name__ == "__main__":
    unittest.main()
