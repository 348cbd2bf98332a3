#!/usr/bin/python3
# timeout: 600
"""cmake --install, then: the program alone, and somebody else's program against the installed library.

The installation is copied elsewhere first and the original removed, so that nothing can refer to the place it was made in.
Argument: build directory."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]


def run(*words, **options):
    print("+", *words, flush=True)
    done = subprocess.run([*map(str, words)], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False, **options)
    if done.returncode != 0:
        print(done.stdout, done.stderr, sep="\n")
        sys.exit(f"exit code {done.returncode}")
    return done.stdout


def check(condition, message):
    if not condition:
        sys.exit(message)


def check_files(prefix):
    """What has to be there, that no header refers to one that is not, and that no file names the source or build folder."""
    for name in ("bin/cgcontact", "include/cgcontact/cgcontact.hpp", "include/cgcontact/contact/simulation.hpp",
                 "share/cgcontact/scenes/two_solids.toml", "share/cgcontact/scenes/data/rail.stl", "share/man/man1/cgcontact.1",
                 "share/bash-completion/completions/cgcontact", "share/doc/cgcontact/docs/scene.md", "share/doc/cgcontact/README.md"):
        check((prefix / name).is_file(), f"{name} is not installed")
    for header in (prefix / "include").rglob("*.hpp"):
        for name in re.findall(r'^#include "(.*)"', header.read_text(), re.M):
            check((prefix / "include" / name).is_file(), f"{header} includes {name}, which is not installed")
    for file in prefix.rglob("*"):
        if file.suffix in (".cmake", ".hpp", ".toml", ".1", ".pc"):
            text = file.read_text()
            # A path of its own, not the end of one: the source folder may be /cgcontact.
            source = re.search(r"(?<![\w.})-])" + re.escape(str(SOURCE)) + "/", text)
            check(not source, f"{file} speaks of {SOURCE}")
            for option in ("-march", "-Werror"):
                check(option not in text, f"{file} speaks of {option}")


def check_alignment(prefix):
    """A file whose Eigen types would have another layout than the library's is refused."""
    done = subprocess.run(["c++", "-std=c++17", "-E", "-DEIGEN_MAX_STATIC_ALIGN_BYTES=8", "-I/usr/include/eigen3",
                           f"-I{prefix / 'include'}", str(prefix / "include" / "cgcontact" / "cgcontact.hpp")],
                          capture_output=True, text=True, check=False)
    check(done.returncode != 0 and "compiled for another alignment" in done.stderr, done.stderr)


def main():
    build = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory(prefix="cgcontact-install-") as folder:
        folder = pathlib.Path(folder)
        run("cmake", "--install", build, "--prefix", folder / "first")
        prefix = folder / "moved here"
        shutil.move(folder / "first", prefix)
        check_files(prefix)

        program, scenes = prefix / "bin" / "cgcontact", prefix / "share" / "cgcontact" / "scenes"
        environment = {key: value for key, value in os.environ.items() if key != "LD_LIBRARY_PATH"}
        out = run(program, "run", scenes / "two_solids.toml", "--set", "n=8", "--out", folder / "out", env=environment)
        check(out.startswith("solved"), out)
        run(program, "check", scenes / "rail.toml", env=environment)
        with_cad = any(prefix.rglob("libcgcontact_cad.so"))
        if with_cad:
            run(program, "check", scenes / "lug.toml", "--set", "n=4", env=environment)
        completions = run("bash", "-c", 'source "$1"; COMP_WORDS=("$2" ""); COMP_CWORD=1; _cgcontact; echo "${COMPREPLY[@]}"', "bash",
                          prefix / "share/bash-completion/completions/cgcontact", program)
        check("init" in completions.split(), completions)

        shutil.copytree(SOURCE / "tests" / "install", folder / "user", ignore=shutil.ignore_patterns("*.py"))
        run("cmake", "-S", folder / "user", "-B", folder / "user-build", f"-DCMAKE_PREFIX_PATH={prefix}", "-DCMAKE_BUILD_TYPE=Release")
        run("cmake", "--build", folder / "user-build", "--verbose")
        commands = (folder / "user-build" / "CMakeFiles" / "user.dir" / "flags.make").read_text()
        check("-march" not in commands, "the library's flags reached the user: " + commands)
        check_alignment(prefix)
        print(run(folder / "user-build" / "user", scenes / "two_solids.toml", *([scenes / "lug.toml"] if with_cad else []),
                  env=environment))


main()
