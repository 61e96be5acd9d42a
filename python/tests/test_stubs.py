"""The stubs say what the module has."""

import ast
import inspect
import pathlib

import treesynth
from treesynth import _treesynth

STUB = ast.parse((pathlib.Path(treesynth.__file__).parent / "_treesynth.pyi").read_text(encoding="utf-8"))


def parameters(function, owner):
    """Names and defaults of a function in the stub."""
    arguments = function.args
    names = [argument.arg for argument in arguments.args]
    is_static = any(getattr(mark, "id", "") == "staticmethod" for mark in function.decorator_list)
    if owner and not is_static:
        names = names[1:]
    plain = arguments.defaults
    defaults = dict(zip(names[len(names) - len(plain) :], map(ast.literal_eval, plain)))
    names += [argument.arg for argument in arguments.kwonlyargs]
    for argument, default in zip(arguments.kwonlyargs, arguments.kw_defaults):
        if default is not None:
            defaults[argument.arg] = ast.literal_eval(default)
    return names, defaults


def check(function, owner, actual):
    signature = inspect.signature(actual)
    found = [name for name in signature.parameters if name != "self"]
    names, defaults = parameters(function, owner)
    assert found == names, (function.name, found, names)
    for name in found:
        default = signature.parameters[name].default
        if default is not inspect.Parameter.empty:
            assert repr(defaults[name]).rstrip("0").rstrip(".") == repr(default).rstrip("0").rstrip("."), (
                function.name,
                name,
            )
        else:
            assert name not in defaults, (function.name, name)


def test_the_stub_and_the_module_agree():
    classes = [node for node in STUB.body if isinstance(node, ast.ClassDef) and not node.name.startswith("_")]
    functions = [node for node in STUB.body if isinstance(node, ast.FunctionDef)]
    told = {node.name for node in classes + functions} | {"__version__"}
    there = {name for name in vars(_treesynth) if not name.startswith("_")} | {"__version__"}
    assert told == there == set(treesynth.__all__)
    for function in functions:
        check(function, None, getattr(treesynth, function.name))
    for owner in classes:
        actual = getattr(treesynth, owner.name)
        methods = [node for node in owner.body if isinstance(node, ast.FunctionDef)]
        public = {name for name in vars(actual) if not name.startswith("_")}
        if owner.name != "TreesynthError":
            assert {node.name for node in methods if not node.name.startswith("__")} == public, owner.name
        for method in methods:
            marks = {getattr(mark, "id", "") for mark in method.decorator_list}
            if "property" not in marks and not method.name.startswith("__"):
                check(method, owner, getattr(actual, method.name))
