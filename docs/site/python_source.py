"""The public names of the package, read from its sources and from the types of its module (_core.pyi), not imported."""

import ast
import copy
import inspect
import pathlib
from dataclasses import dataclass, field

SPECIAL = ["__call__", "__contains__", "__getitem__", "__iter__", "__len__"]
# Modules of which a reader of a signature wants the name only.
UNQUALIFIED = ("abbe.", "_core.", "collections.abc.", "typing.", "numpy.typing.", "pathlib.")


@dataclass
class Name:
    """A name of the package or of a class: kind is class, exception, function, data, method or property."""

    name: str
    kind: str
    doc: str = ""
    signatures: list[str] = field(default_factory=list)  # "(a: int) -> str"
    type: str = ""  # of data and properties
    flags: list[str] = field(default_factory=list)  # options of the directive: "staticmethod", ...
    bases: list[str] = field(default_factory=list)
    members: list["Name"] = field(default_factory=list)
    gives: set[str] = field(default_factory=set)  # names in the types of results
    takes: list[str] = field(default_factory=list)  # names in the types of arguments
    exported: bool = True  # False: only results lead to it, nobody can import it from the package


class Types(ast.NodeTransformer):
    """Types as a reader writes them: without modules that say nothing, aliases and `Union` spelled out."""

    def __init__(self, aliases: dict[str, ast.expr]) -> None:
        self.aliases = aliases

    def visit_Name(self, node: ast.Name) -> ast.expr:
        alias = self.aliases.get(node.id)
        return self.visit(copy.deepcopy(alias)) if alias is not None else node

    def visit_Constant(self, node: ast.Constant) -> ast.expr:
        return self.visit(ast.parse(node.value, mode="eval").body) if isinstance(node.value, str) else node

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        text = ast.unparse(node)
        for module in UNQUALIFIED:
            text = text.removeprefix(module)
        return ast.parse(text, mode="eval").body

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        kind = ast.unparse(node.value).rpartition(".")[2]
        if kind == "Literal":
            return node
        parts = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        if kind == "Annotated":
            return self.visit(parts[0])
        parts = [self.visit(part) for part in parts]
        if kind in ("Union", "Optional"):
            parts += [ast.Constant(None)] if kind == "Optional" else []
            return ast.parse(" | ".join(ast.unparse(part) for part in parts), mode="eval").body
        inner = ast.Tuple(parts, ast.Load()) if isinstance(node.slice, ast.Tuple) else parts[0]
        return ast.Subscript(self.visit(node.value), inner, ast.Load())


class Source:
    """One file of the package."""

    def __init__(self, path: pathlib.Path) -> None:
        text = path.read_text(encoding="utf-8")
        self.lines = text.splitlines()
        self.tree = ast.parse(text)
        self.aliases = {
            node.targets[0].id: node.value
            for node in self.tree.body
            if isinstance(node, ast.Assign)
            and isinstance(node.targets[0], ast.Name)
            and isinstance(node.value, ast.Subscript)
            and ast.unparse(node.value.value).endswith("Union")
        }

    def type(self, node: ast.expr | None) -> str:
        if node is None:
            return ""
        return ast.unparse(Types(self.aliases).visit(ast.parse(ast.unparse(node), mode="eval").body))

    def comment(self, node: ast.stmt) -> str:
        """What `#:` says about a name: after it, or on the lines before it."""
        after = self.lines[node.end_lineno - 1].partition("#:")[2].strip()
        before: list[str] = []
        number = node.lineno - 2
        while not after and number >= 0 and self.lines[number].lstrip().startswith("#:"):
            before.insert(0, self.lines[number].partition("#:")[2].strip())
            number -= 1
        return after or " ".join(before)

    def names(self) -> dict[str, Name]:
        return self.read(self.tree.body, in_class=False)

    def read(self, body: list[ast.stmt], in_class: bool) -> dict[str, Name]:
        found: dict[str, Name] = {}
        for node in body:
            if isinstance(node, ast.ClassDef):
                found[node.name] = self.class_of(node)
            elif isinstance(node, ast.FunctionDef):
                self.add_function(found, node, in_class)
            elif isinstance(node, (ast.AnnAssign, ast.Assign)):
                target = node.target if isinstance(node, ast.AnnAssign) else node.targets[0]
                if isinstance(target, ast.Name):
                    kind = self.type(node.annotation) if isinstance(node, ast.AnnAssign) else ""
                    found[target.id] = Name(
                        target.id,
                        "property" if in_class else "data",
                        self.comment(node),
                        type=kind,
                        gives=mentioned(kind),
                    )
        return found

    def add_function(self, found: dict[str, Name], node: ast.FunctionDef, in_class: bool) -> None:
        decorators = {ast.unparse(each).rpartition(".")[2] for each in node.decorator_list}
        doc = inspect.cleandoc(ast.get_docstring(node) or "")
        if "setter" in decorators:
            found[node.name].flags.append("settable")
            return
        if decorators & {"property", "cached_property"}:
            kind = self.type(node.returns)
            found[node.name] = Name(node.name, "property", doc, type=kind, gives=mentioned(kind))
            return
        one = found.setdefault(node.name, Name(node.name, "method" if in_class else "function"))
        one.doc = "\n\n".join(filter(None, [one.doc, doc if doc != one.doc else ""]))
        one.flags = [flag for flag in ("classmethod", "staticmethod") if flag in decorators]
        one.signatures.append(self.signature(node, bound=in_class and "staticmethod" not in decorators))
        one.gives |= mentioned(self.type(node.returns)) - ({node.name} if not in_class else set())
        for argument in [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]:
            one.takes += sorted(mentioned(self.type(argument.annotation)))

    def signature(self, node: ast.FunctionDef, bound: bool) -> str:
        arguments = copy.deepcopy(node.args)
        for each in [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs, arguments.vararg, arguments.kwarg]:
            if each is not None and each.annotation is not None:
                each.annotation = ast.parse(self.type(each.annotation), mode="eval").body
        if bound:
            (arguments.posonlyargs or arguments.args).pop(0)
        # nanobind takes what has no name by place; nobody writes that in a call.
        arguments.args = arguments.posonlyargs + arguments.args
        arguments.posonlyargs = []
        result = self.type(node.returns)
        return f"({ast.unparse(arguments)})" + (f" -> {result}" if result and node.name != "__init__" else "")

    def class_of(self, node: ast.ClassDef) -> Name:
        members = self.read(node.body, in_class=True)
        bases = [self.type(base) for base in node.bases]
        one = Name(
            node.name,
            "exception" if any(base.endswith(("Error", "Exception")) for base in bases) else "class",
            inspect.cleandoc(ast.get_docstring(node) or ""),
            bases=bases,
        )
        start = members.pop("__init__", None)
        if start is not None:
            one.signatures = start.signatures
            one.doc = "\n\n".join(filter(None, [one.doc, start.doc]))
            one.takes = start.takes
        elif any("dataclass" in ast.unparse(each) for each in node.decorator_list):
            fields = [each for each in node.body if isinstance(each, ast.AnnAssign)]
            words = [
                f"{each.target.id}: {self.type(each.annotation)}"
                + (f" = {ast.unparse(each.value)}" if each.value is not None else "")
                for each in fields
            ]
            one.signatures = [f"({', '.join(words)})"]
        one.members = [each for name, each in members.items() if not name.startswith("_") or name in SPECIAL]
        one.gives = set().union(*(each.gives for each in one.members)) - {one.name}
        one.takes += [name for each in one.members for name in each.takes if name != one.name]
        return one


def mentioned(kind: str) -> set[str]:
    """Names without a module in a type."""
    return {node.id for node in ast.walk(ast.parse(kind or "None", mode="eval")) if isinstance(node, ast.Name)}


def public_names(package: pathlib.Path) -> dict[str, Name]:
    """The names of abbe.__all__, in its order, then the types of parts of results that only the module has."""
    tree = ast.parse((package / "__init__.py").read_text(encoding="utf-8"))
    home: dict[str, str] = {}
    wanted: list[str] = []
    for node in tree.body:
        if isinstance(node, ast.ImportFrom) and node.level == 1 and node.module:
            home.update({each.asname or each.name: node.module for each in node.names})
        elif isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__":
            wanted = ast.literal_eval(node.value)
    sources: dict[str, dict[str, Name]] = {}
    for module in {*home.values(), "_core"}:
        path = package / f"{module}.pyi"
        sources[module] = Source(path if path.exists() else package / f"{module}.py").names()
    missing = [name for name in wanted if name not in home or name not in sources[home[name]]]
    if missing:
        raise ValueError(f"{package}: not found in the sources of the package: {', '.join(missing)}")
    names = {name: sources[home[name]][name] for name in wanted}
    left = list(names.values())
    while left:
        for name in sorted(left.pop().gives & sources["_core"].keys() - names.keys()):
            if not name.startswith("_"):
                names[name] = sources["_core"][name]
                names[name].exported = False
                left.append(names[name])
    return names


def module_names(path: pathlib.Path) -> dict[str, Name]:
    """The names of a module that are public, and what it says about itself as `__doc__`."""
    source = Source(path)
    names = {name: one for name, one in source.names().items() if not name.startswith("_")}
    return {"__doc__": Name("__doc__", "data", inspect.cleandoc(ast.get_docstring(source.tree) or "")), **names}
