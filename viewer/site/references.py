#!/usr/bin/env python3
"""Writes the pages of the references as JSON: of the package for Python, from its sources; of the public headers, from
Doxygen's XML; and of the programs, from their help texts.

usage: references.py ROOT XML_FOLDER PROGRAM
[{"path", "title", "group", "html", "sections": [{"anchor", "title", "level", "text"}, ...]}, ...]; a folder or a program that is empty text
leaves its pages out.
"""
import ast
import html
import json
import pathlib
import re
import subprocess
import sys
import xml.etree.ElementTree as xml


class Page:
    def __init__(self, path, title, group):
        self.fields = {"path": path, "title": title, "group": group}
        self.html = f"<h1>{html.escape(title)}</h1>\n"
        self.sections = [{"anchor": "", "title": title, "level": 1, "text": ""}]
        self.anchors = set()

    def heading(self, level, title, anchor):
        while anchor in self.anchors:
            anchor += "-"
        self.anchors.add(anchor)
        label = html.escape(f"Link to {title}")
        self.html += (f'<h{level} id="{html.escape(anchor)}">{html.escape(title)}'
                      f'<a class="anchor" href="#{html.escape(anchor)}" aria-label="{label}">#</a></h{level}>\n')
        self.sections.append({"anchor": anchor, "title": title, "level": level, "text": ""})

    def text(self, text):
        """Paragraphs; indented lines are code, and `names` are in the letters of code."""
        for part in re.split(r"\n\s*\n", text.strip("\n")):
            if not part.strip():
                continue
            self.sections[-1]["text"] += " " + " ".join(part.split())
            if all(line.startswith("    ") for line in part.split("\n") if line):
                code = "\n".join(line[4:] for line in part.split("\n"))
                self.html += f'<div class="code"><pre tabindex="0"><code>{html.escape(code)}\n</code></pre></div>\n'
            else:
                self.html += "<p>" + re.sub(r"`([^`]+)`", r"<code>\1</code>", html.escape(part, quote=False)) + "</p>\n"

    def signature(self, text):
        self.sections[-1]["text"] += " " + " ".join(text.split())
        self.html += f'<pre class="signature" tabindex="0"><code>{html.escape(text)}</code></pre>\n'

    def json(self):
        return {**self.fields, "html": self.html, "sections": self.sections}


# Python ------------------------------------------------------------------------------------------------------------
def is_public(name):
    return not name.startswith("_") or name in ("__init__", "__call__", "__enter__", "__len__", "__getitem__")


def signature(node, name):
    arguments = ast.unparse(node.args)
    returns = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    if any(ast.unparse(each) == "property" for each in node.decorator_list):
        return f"{name}: {ast.unparse(node.returns)}" if node.returns else name
    arguments = re.sub(r"^self(, )?", "", arguments)
    text = f"{name}({arguments}){returns}"
    if len(text) > 100:
        text = f"{name}({wrapped(arguments)}){returns}"
    return text


def wrapped(arguments):
    """One argument on each line; commas inside brackets part nothing."""
    lines, depth, line = [], 0, ""
    for letter in arguments:
        depth += (letter in "([{") - (letter in ")]}")
        if letter == "," and depth == 0:
            lines.append(line.strip() + ",")
            line = ""
        else:
            line += letter
    return "\n    " + "\n    ".join([*lines, line.strip()]) + "\n"


def python_module(root, path, name):
    tree = ast.parse((root / path).read_text())
    page = Page(f"reference/python-{name.replace('.', '-')}.html", name, "Reference: Python")
    page.text(ast.get_docstring(tree) or "")
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and is_public(node.name):
            page.heading(2, node.name, node.name)
            page.signature(signature(node, node.name))
            page.text(ast.get_docstring(node) or "")
        if not isinstance(node, ast.ClassDef) or not is_public(node.name):
            continue
        page.heading(2, node.name, node.name)
        bases = ", ".join(ast.unparse(base) for base in node.bases)
        page.signature(f"class {node.name}" + (f"({bases})" if bases else ""))
        page.text(ast.get_docstring(node) or "")
        for member in node.body:
            if isinstance(member, ast.AnnAssign) and isinstance(member.target, ast.Name) and is_public(member.target.id):
                value = f" = {ast.unparse(member.value)}" if member.value else ""
                page.signature(f"{member.target.id}: {ast.unparse(member.annotation)}{value}")
            if isinstance(member, ast.FunctionDef) and is_public(member.name):
                shown = node.name if member.name == "__init__" else member.name
                if member.name != "__init__":
                    page.heading(3, f"{node.name}.{member.name}", f"{node.name}.{member.name}")
                page.signature(signature(member, shown).replace(" -> None", "" if member.name == "__init__" else " -> None"))
                page.text(ast.get_docstring(member) or "")
    return page


def python_pages(root):
    package = root / "python/troupe"
    pages = [python_module(root, "python/troupe/_troupe.pyi", "troupe")]
    pages[0].html = pages[0].html.replace("The native part of troupe. ", "")
    for path in sorted(package.glob("*.py")):
        if path.stem not in ("__init__", "errors") and is_public(path.stem):
            pages.append(python_module(root, path.relative_to(root), f"troupe.{path.stem}"))
    for path in sorted((package / "rl").glob("*.py")):
        if path.stem == "__init__" or is_public(path.stem):
            name = "troupe.rl" if path.stem == "__init__" else f"troupe.rl.{path.stem}"
            pages.append(python_module(root, path.relative_to(root), name))
    return [page for page in pages if len(page.sections) > 1]


# C++ ---------------------------------------------------------------------------------------------------------------
def words(node):
    """The text of a description: paragraphs apart by empty lines, code indented."""
    if node is None:
        return ""
    out = []

    def inline(each):
        text = (each.text or "")
        for child in each:
            inner = inline(child)
            if child.tag == "computeroutput":
                inner = f"`{inner}`"
            text += inner + (child.tail or "")
        return text

    def walk(each):
        if each.tag == "para":
            out.append(" ".join(inline(each).split()))
        elif each.tag == "programlisting":
            lines = ["    " + "".join(" " if x.tag == "sp" else (x.text or "") + (x.tail or "") for x in line.iter() if x.tag in ("highlight", "sp", "ref"))
                     for line in each.iter("codeline")]
            out.append("\n".join(lines))
        else:
            for child in each:
                walk(child)

    for child in node:
        walk(child)
    return "\n\n".join(part for part in out if part.strip())


def described(node):
    return "\n\n".join(filter(None, (words(node.find("briefdescription")), words(node.find("detaileddescription")))))


def declared(member):
    def text(tag):
        found = member.find(tag)
        return " ".join("".join(found.itertext()).split()) if found is not None else ""

    kind = member.get("kind")
    if kind == "enum":
        names = [value.find("name").text for value in member.findall("enumvalue")]
        return f"enum class {text('name')} {{{', '.join(names)}}}"
    if kind == "typedef":
        return f"using {text('name')} = {text('type')}"
    template = member.find("templateparamlist")
    head = "template <" + ", ".join(" ".join("".join(p.itertext()).split()) for p in template) + ">\n" if template is not None else ""
    static = "static " if member.get("static") == "yes" and kind == "function" else ""
    line = f"{head}{static}{text('type')} {text('name')}{text('argsstring')}".strip()
    if kind == "variable" and text("initializer"):
        line += f" {text('initializer')}"
    return line if len(line) < 110 else re.sub(r"\((.*)\)", lambda match: f"({wrapped(match.group(1))})", line, count=1)


def cpp_page(root, file, folder):
    """Of a header, with its classes."""
    tree = xml.parse(folder / f"{file}.xml").getroot().find("compounddef")
    name = tree.find("compoundname").text
    page = Page(f"reference/cpp-{name.replace('.', '-')}.html", f"troupe/{name}", "Reference: C++")
    page.text(described(tree))

    def members(definition, prefix, level):
        for member in definition.iter("memberdef"):
            title = member.find("name").text
            if member.get("prot", "public") == "private" or member.get("kind") == "friend" or title.startswith("@"):
                continue
            description = described(member)
            if prefix and member.get("kind") == "variable":
                page.signature(declared(member))
            else:
                if not prefix:
                    page.heading(level, title, title)
                page.signature(declared(member))
            page.text(description)

    for inner in tree.findall("innerclass"):
        definition = xml.parse(folder / f"{inner.get('refid')}.xml").getroot().find("compounddef")
        if definition.get("prot", "public") == "private":
            continue
        title = definition.find("compoundname").text.removeprefix("troupe::")
        page.heading(2, title, title)
        page.signature(f"{definition.get('kind')} {title}")
        page.text(described(definition))
        members(definition, title, 3)
    members(tree, "", 2)
    return page


def cpp_pages(root, folder):
    index = xml.parse(folder / "index.xml").getroot()
    files = [each.get("refid") for each in index.findall("compound") if each.get("kind") == "file"
             and each.find("name").text.endswith(".h")]
    return [page for page in (cpp_page(root, file, folder) for file in files) if len(page.sections) > 1]


# Programs ----------------------------------------------------------------------------------------------------------
def output(program, *arguments):
    return subprocess.run([program, *arguments], capture_output=True, text=True, check=True).stdout


def program_page(program):
    page = Page("reference/commands.html", "Commands", "Reference: programs")
    page.text("The help texts of `troupe` and its commands.")
    for command in re.findall(r"^  ([a-z][a-z-]+) {2,}", output(program, "--help").split("Subcommands:")[-1], re.MULTILINE):
        page.heading(2, f"troupe {command}", command)
        page.signature(output(program, command, "--help").strip())
    return page


def main(root, folder, program):
    root = pathlib.Path(root)
    pages = python_pages(root)
    if folder:
        pages += cpp_pages(root, pathlib.Path(folder))
    if program:
        pages.append(program_page(program))
    json.dump([page.json() for page in pages], sys.stdout)


if __name__ == "__main__":
    main(*sys.argv[1:])
