#!/usr/bin/python3
"""Makes a wheel of the Python module from a build: make_wheel.py BUILD DIRECTORY

cgcontact-VERSION-cpXY-cpXY-linux_ARCH.whl, for the Python that runs this. Its libraries stay those of the system: the metadata names
the Debian packages that hold them."""
import os
import pathlib
import re
import subprocess
import sys
import sysconfig
import tempfile

METADATA = """Metadata-Version: 2.1
Name: cgcontact
Version: {version}
Summary: 3D contact between elastic bodies on Cartesian grids
Requires-Python: =={python}.*
Requires-Dist: numpy
{libraries}
The module uses shared libraries of the system. The lines "Requires-External" name the Debian packages that hold them,
which pip does not install; a path stands for a library of no package.
"""
WHEEL = """Wheel-Version: 1.0
Generator: cgcontact
Root-Is-Purelib: false
Tag: {tag}
"""


def run(*words):
    try:
        return subprocess.run([*map(str, words)], capture_output=True, text=True, check=False)
    except OSError as error:
        sys.exit(f"make_wheel.py: {words[0]}: {error}")


def output_of(*words):
    """What a program prints; its error ends this one."""
    done = run(*words)
    if done.returncode != 0:
        sys.exit(f"make_wheel.py: {' '.join(map(str, words))}: {done.stderr.strip() or done.stdout.strip()}")
    return done.stdout


def cache_of(build):
    """The entries of CMakeCache.txt."""
    try:
        return dict(re.findall(r"^(\w+):\w+=(.*)$", (build / "CMakeCache.txt").read_text(), re.M))
    except OSError as error:
        sys.exit(f"make_wheel.py: {build} is no build of cgcontact: {error}")


def needed_libraries(file):
    """Paths of the libraries that a file is linked with, without theirs."""
    paths = dict(re.findall(r"^\s*(\S+) => (/\S+)", output_of("ldd", file), re.M))
    return {paths[name] for name in re.findall(r"^\s+NEEDED\s+(\S+)", output_of("objdump", "-p", file), re.M) if name in paths}


def requirements(libraries):
    """The Debian packages that hold libraries, and the paths of those that none holds."""
    paths = {os.path.realpath(library) for library in libraries}
    names = {name: path for path in paths for name in (path, path.removeprefix("/usr"))}  # dpkg may know /usr/lib as /lib
    found = run("dpkg-query", "--search", *names).stdout  # it fails where one name is not known
    packages = {names[name]: package for package, name in re.findall(r"^([^\s:]+)(?::\w+)?: (/\S+)$", found, re.M)}
    return sorted({packages.get(path, path) for path in paths})


def tag():
    """Python, its ABI and the platform, as Python names them: no promise for other distributions (manylinux)."""
    abi = "cp" + sysconfig.get_config_var("SOABI").split("-")[1]
    return f"{abi}-{abi}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: make_wheel.py BUILD DIRECTORY")
    build, directory = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    cache = cache_of(build)
    version = cache["CMAKE_PROJECT_VERSION"]
    directory.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="cgcontact-wheel-") as folder:
        content = pathlib.Path(folder)
        output_of(cache["CMAKE_COMMAND"], "--install", build, "--component", "wheel", "--prefix", content)
        files = sorted((content / "cgcontact").glob("*.so"))
        external = requirements(library for file in files for library in needed_libraries(file))
        information = content / f"cgcontact-{version}.dist-info"
        information.mkdir()
        (information / "METADATA").write_text(METADATA.format(
            version=version, python=sysconfig.get_python_version(),
            libraries="".join(f"Requires-External: {package}\n" for package in external)))
        (information / "WHEEL").write_text(WHEEL.format(tag=tag()))
        output_of(sys.executable, "-m", "wheel", "pack", content, "--dest-dir", directory)
    print(directory / f"cgcontact-{version}-{tag()}.whl")


main()
