#!/usr/bin/env python3
"""A name that only one .cpp file knows (of an unnamed namespace, a constant, `static`) is no name of another file of its library nor of a
header that it may include: the files of a library are compiled in groups as one (CMake's unity build), and each new file shifts the groups.
Complains about types, variables and constants of one name, and about functions of one name with the same parameters; in headers too about
types and constants, which libraries must not give two meanings.

  scripts/check_file_names.py [ROOT]

Reads declarations at the level of namespaces, as this repository is written: no macros that declare something.
"""
import itertools
import pathlib
import re
import sys

LIBRARIES = ("core", "kernels", "recovery", "contact")
# Compiled by themselves (core/CMakeLists.txt).
ALONE = ("core/bodies/triangle_booleans.cpp", "core/triangles/triangle_arrangement.cpp", "core/triangles/triangle_repair.cpp")
# First words of declarations in a .cpp file that no other file sees, also outside of unnamed namespaces.
LOCAL = ("const", "constexpr", "static", "struct", "class", "enum", "union", "using")
CLOSING = {"(": ")", "[": "]", "{": "}"}
SPECIFIERS = {"const", "volatile", "unsigned", "signed", "long", "short", "struct", "class", "typename", "::"}
NO_NAMES = {"const", "int", "long", "short", "char", "double", "float", "bool", "auto", "unsigned", "signed", "void"}
# What is no declaration; numbers, which may hold apostrophes; names and signs.
TOKEN = re.compile(r"""
    (?P<skipped> \s+ | //[^\n]* | /\*.*?\*/ | ^[ \t]*\#(?:[^\n\\]|\\.)* | \[\[.*?\]\] )
  | (?P<text> \w*R"(?P<mark>[^(\s]*)\(.*?\)(?P=mark)" | "(?:[^"\\]|\\.)*" | '(?:[^'\\]|\\.)*' )
  | (?P<token> \bHandle\(\w+\) | \d(?:[\w.]|'\w)* | \w+ | :: | -> | . )""", re.VERBOSE | re.DOTALL | re.MULTILINE)


def tokens_of(text):
    """Lists (token, line); texts in quotes are one token each."""
    found, line = [], 1
    for match in TOKEN.finditer(text):
        if not match["skipped"]:
            found.append((match["token"] or '""', line))
        line += match[0].count("\n")
    return found


def after_brackets(tokens, i):
    """The position after the bracket that closes the one at `i`."""
    depth = 0
    while i < len(tokens):
        depth += (tokens[i] in CLOSING) - (tokens[i] in CLOSING.values())
        i += 1
        if depth == 0:
            break
    return i


def after_angles(tokens, i):
    """The position after the `>` that closes the `<` at `i`."""
    depth = 0
    while i < len(tokens):
        depth += (tokens[i] == "<") - (tokens[i] == ">")
        i = after_brackets(tokens, i) if tokens[i] in CLOSING else i + 1
        if depth == 0:
            break
    return i


def end_of_head(tokens, i, ends):
    """The position of the first token of `ends` outside of `< >`."""
    while i < len(tokens) and tokens[i] not in ends:
        i = after_angles(tokens, i) if tokens[i] == "<" else i + 1
    return i


def end_of_statement(tokens, i):
    """The position after the declaration at `i`: after its semicolon or the body of its function."""
    head = end_of_head(tokens, i, "=({;")
    function, members = head < len(tokens) and tokens[head] == "(", False
    while i < len(tokens) and tokens[i] not in (";", "}"):
        before, at = tokens[i - 1], i
        members |= function and tokens[i] == ":" and before == ")"  # of a constructor
        i = after_brackets(tokens, i) if tokens[i] in CLOSING else i + 1
        if function and tokens[at] == "{" and (not members or before in (")", "}")):
            return i
    return i + 1


def parts(tokens):
    """The parts of a list between its commas."""
    part, i, head = [], 0, True
    while i < len(tokens):
        if tokens[i] == ",":
            yield part
            part, i, head = [], i + 1, True
            continue
        head &= tokens[i] not in ("=", "{")
        end = (after_brackets(tokens, i) if tokens[i] in CLOSING else
               after_angles(tokens, i) if tokens[i] == "<" and head else i + 1)
        part += tokens[i:end]
        i = end
    if part:
        yield part


def parameter_types(tokens):
    """The types of a function's parameters, without their names and defaults."""
    types = []
    for part in parts(tokens):
        part = part[:end_of_head(part, 0, "=[")]
        named = len(part) > 1 and re.match(r"[A-Za-z_]", part[-1]) and part[-2] not in SPECIFIERS and part[-1] not in NO_NAMES
        types.append(" ".join(part[:-1] if named else part))
    return tuple(types)


def declared(tokens):
    """Yields (name, types of the parameters or None) for each name that a declaration makes; not what is qualified."""
    if tokens[0] == "template":
        if tokens[1:3] == ["<", ">"] or tokens[1] != "<":  # of a template that another declaration has made
            return
        tokens = tokens[after_angles(tokens, 1):]
    if tokens[0] in ("struct", "class", "enum", "union"):
        name = 2 if tokens[1] in ("struct", "class") else 1
        if "{" in tokens and tokens[name + 1] in ("{", ":", "final"):
            yield tokens[name], None
        return
    if tokens[0] == "using":
        if tokens[2] == "=":
            yield tokens[1], None
        return
    if tokens[0] in ("namespace", "static_assert"):  # another name of a namespace may be given twice
        return
    head = end_of_head(tokens, 0, "=({[;")
    if head < len(tokens) and tokens[head] == "(":
        if tokens[head - 2] != "::" and "operator" not in tokens[:head]:
            yield tokens[head - 1], parameter_types(tokens[head + 1:after_brackets(tokens, head) - 1])
        return
    for part in parts(tokens[:-1] if tokens[-1] == ";" else tokens):
        end = end_of_head(part, 0, "={[")
        if end > 0 and part[end - 2:end - 1] != ["::"]:
            yield part[end - 1], None


def declarations(text):
    """Lists (scope, name, types of parameters or None, line, whether only the file knows it); scope: its named namespaces."""
    numbered = tokens_of(text)
    tokens = [token for token, _ in numbered]
    found, scopes, i = [], [], 0
    while i < len(tokens):
        if tokens[i] == "namespace" and "{" in tokens[i + 1:i + 3]:
            scopes.append(tokens[i + 1] if tokens[i + 1] != "{" else "")
            i += 3 if scopes[-1] else 2
        elif tokens[i] == "}" and scopes:
            scopes.pop()
            i += 1
        elif tokens[i] in (";", "}"):
            i += 1
        elif tokens[i] == "catch":  # of a function that is one `try`
            i = after_brackets(tokens, after_brackets(tokens, i + 1))
        else:
            end = end_of_statement(tokens, i)
            for name, types in declared(tokens[i:end]):
                local = "" in scopes or tokens[i] == "static" or types is None and tokens[i] in LOCAL
                found.append(("::".join(filter(None, scopes)), name, types, numbered[i][1], local))
            i = end
    return found


def clashes(root, libraries):
    """Lists messages for names of the last library: of a file that another file or a header has, of a header that another one has."""
    known = {}  # places of a name in headers and in files of this library
    for library in libraries:
        for path in sorted((root / library).rglob("*.[ch]pp")):
            file = path.relative_to(root).as_posix()
            header = path.suffix == ".hpp"
            if file in ALONE or not (header or library == libraries[-1]):
                continue
            for scope, name, types, line, local in declarations(path.read_text(encoding="utf-8")):
                if header or local:
                    known.setdefault((scope, name), []).append((file, line, types, not header))
    messages = []
    for (_, name), places in known.items():
        for one, other in itertools.combinations(places, 2):
            functions = one[2] is not None and other[2] is not None
            local = one[3] or other[3]
            if one[0] == other[0] or functions and (one[2] != other[2] or not local):  # headers may declare a function twice
                continue
            there, file = sorted((one, other), key=lambda place: (place[3], place[0].startswith(libraries[-1] + "/")))
            if file[0].startswith(libraries[-1] + "/"):
                messages.append(f"{file[0]}:{file[1]}: {name} is a name of {there[0]}:{there[1]} too")
    return sorted(messages)


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent)
    messages = [message for k in range(len(LIBRARIES)) for message in clashes(root, LIBRARIES[:k + 1])]
    for message in messages:
        print(message)
    return 1 if messages else 0


if __name__ == "__main__":
    sys.exit(main())
