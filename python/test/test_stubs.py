"""The type stubs say what the module offers: the same names, and for each function the same arguments and defaults."""
import ast
import inspect
import re
import shutil
import subprocess
import unittest
from pathlib import Path

import e2lf

STUB = Path(e2lf.__file__).with_suffix(".pyi")


def signature_of_stub(function):
    return arguments_of(function.args)


def signature_of_module(function, name):
    """Of pybind11's functions by the first line of their documentation; None where that holds no signature."""
    if inspect.isfunction(function):
        return arguments_of(ast.parse(inspect.getsource(function)).body[0].args)
    text = (function.__doc__ or "").split("\n")[0]
    return arguments_of(ast.parse(f"def {text}: ...").body[0].args)


def arguments_of(arguments):
    """[(name, whether it is given by name alone, default)]."""
    def plain(default):
        return None if default is None else repr(ast.literal_eval(default))

    places = [None] * (len(arguments.args) - len(arguments.defaults)) + arguments.defaults
    found = [(argument.arg, False, plain(default)) for argument, default in zip(arguments.args, places)]
    found += [(argument.arg, True, plain(default)) for argument, default in zip(arguments.kwonlyargs, arguments.kw_defaults)]
    return found


def text_of(thing):
    """The documentation without the signature that pybind11 puts before it."""
    text = (thing.__doc__ or "").strip()
    return re.sub(r"^\w+\(.*\n+", "", text)


class StubTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        body = ast.parse(STUB.read_text()).body
        cls.functions = {node.name: node for node in body if isinstance(node, ast.FunctionDef)}
        cls.classes = {node.name: node for node in body if isinstance(node, ast.ClassDef)}
        cls.values = {node.target.id for node in body if isinstance(node, ast.AnnAssign)}
        cls.tuples = {alias.name for node in body if isinstance(node, ast.ImportFrom) and node.level for alias in node.names}

    def test_it_names_what_there_is(self):
        self.assertEqual(sorted({*self.functions, *self.classes, *self.values, *self.tuples} - {"__version__"}), sorted(e2lf.__all__))

    def test_functions_have_its_arguments(self):
        for name, stub in self.functions.items():
            self.assertEqual(signature_of_module(getattr(e2lf, name), name), signature_of_stub(stub), name)

    def test_everything_is_documented(self):
        for name in e2lf.__all__:
            thing = getattr(e2lf, name)
            if not callable(thing):
                continue
            text = thing.__doc__ or ""
            has_signature = type(thing).__name__ == "builtin_function_or_method"
            self.assertTrue(text.split("\n", 2)[2 if has_signature else 0].strip(), name)

    def documented(self):
        """(name, what the stub says, its documentation without the signature) of functions, methods and properties."""
        for name, stub in self.functions.items():
            yield name, stub, text_of(getattr(e2lf, name))
        for name, stub in self.classes.items():
            for method in stub.body:
                if isinstance(method, ast.FunctionDef) and not method.name.startswith("__"):
                    yield f"{name}.{method.name}", method, text_of(getattr(getattr(e2lf, name), method.name))

    def test_every_argument_is_explained(self):
        plain = {"self", "path", "output", "overwrite", "width", "height"}  # their names say it
        for name, stub, text in self.documented():
            self.assertTrue(text, name)
            for argument in (*stub.args.args, *stub.args.kwonlyargs):
                if argument.arg not in plain:
                    self.assertRegex(text, rf"\b{argument.arg}\b", f"{name} does not explain {argument.arg}")

    def test_shapes_and_units_are_said(self):
        axes = r"\[[\w +-]+(, [\w +-]+)*\]|of the same shape|event_dtype|fields x, y|Slice|DisparityMap"
        for name, stub, text in self.documented():
            types = ast.unparse(stub)
            if re.search(r"\b(Array|Floats|Counts|Slice|EventImageFile|DisparityMap)\b", types):
                self.assertRegex(text, axes, f"{name} names no axes")
            if re.search(r"_us\b|delta_t|t_us", types):
                self.assertRegex(text, r"\bus\b|_us\b|Slice", f"{name} names no unit of time")
            if re.search(r"disparity|_px\b", types):
                self.assertRegex(text, r"\bpx\b", f"{name} names no unit of length")

    def test_classes_have_its_methods_and_attributes(self):
        for name, stub in self.classes.items():
            thing = getattr(e2lf, name)
            methods = {node.name: node for node in stub.body if isinstance(node, ast.FunctionDef)}
            fields = {node.target.id for node in stub.body if isinstance(node, ast.AnnAssign)}
            there = {word for word in dir(thing) if not word.startswith("_")} - set(dir(Exception)) - set(dir(tuple))
            public = {word for word in (*methods, *fields) if not word.startswith("_")}
            self.assertEqual(there - {"_fields"}, public, name)
            for word, method in methods.items():
                attribute = getattr(thing, word)
                is_property = any(isinstance(node, ast.Name) and node.id == "property" for node in method.decorator_list)
                self.assertEqual(isinstance(attribute, property), is_property, f"{name}.{word}")
                if is_property or word in ("__exit__", "__enter__", "__iter__", "__next__", "__len__"):
                    continue
                self.assertEqual(signature_of_module(attribute, word), signature_of_stub(method), f"{name}.{word}")

    @unittest.skipUnless(shutil.which("mypy"), "mypy is not installed")
    def test_a_type_checker_accepts_the_package_and_the_examples(self):
        examples = Path(__file__).resolve().parents[2] / "examples"
        files = map(str, [STUB, *sorted(STUB.parent.glob("torch/*.py")), *sorted(examples.rglob("*.py"))])
        # OpenCV and Dask state no types.
        done = subprocess.run(["mypy", "--strict", "--ignore-missing-imports", "--allow-untyped-calls",
                               f"--cache-dir={STUB.parents[1] / 'mypy'}", *files], capture_output=True, text=True,
                              env={"MYPYPATH": str(STUB.parent.parent), "PATH": "/usr/bin:/bin"})
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
