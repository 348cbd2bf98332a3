#!/bin/bash
# Installs the Debian packages that cgcontact needs and that are missing. Does nothing, quickly, when all are there.
#
#   scripts/install_dependencies.sh            to build and to run
#   scripts/install_dependencies.sh --test     what the tests use as well, and ccache
#   scripts/install_dependencies.sh --docs     doxygen as well
#   scripts/install_dependencies.sh --format   clang-format as well
#   scripts/install_dependencies.sh --tidy     clang-tidy as well
#   scripts/install_dependencies.sh --wheel    what make wheel uses as well
#   scripts/install_dependencies.sh --fuzz     clang with libFuzzer as well
#   scripts/install_dependencies.sh --tsan     clang with its OpenMP and thread sanitizer as well
#   scripts/install_dependencies.sh --trilinos what build_trilinos_openmp.sh uses as well
set -euo pipefail

# trilinos-all-dev: its component packages refer to each other in their CMake files and do not configure alone.
# libocct-data-exchange-dev: OpenCASCADE, for CAD files; brings its other packages.
# pybind11-dev, python3-dev, python3-numpy: the Python module.
# libpng-dev: pixels below what gnuplot draws.
# libjs-three: the view of report.html.
# libptscotch-dev: Trilinos names its libraries to the linker, but does not depend on it.
packages=(
  g++ make cmake ninja-build
  trilinos-all-dev libptscotch-dev libopenmpi-dev openmpi-bin libhdf5-dev libpng-dev libeigen3-dev
  libtomlplusplus-dev libmuparser-dev libcli11-dev nlohmann-json3-dev libfmt-dev libcgal-dev libocct-data-exchange-dev
  libgtest-dev libbenchmark-dev
  pybind11-dev python3-dev python3-numpy
  gnuplot-nox libjs-three
)
for option in "$@"; do
  case "$option" in
    --test) packages+=(ccache python3 python3-vtk9 python3-h5py python3-matplotlib python3-scipy python3-meshio
      python3-pandas python3-pip python3-wheel groff-base
      chromium chromium-driver python3-selenium) ;;
    --docs) packages+=(doxygen graphviz) ;;
    --format) packages+=(clang-format-14) ;;
    --tidy) packages+=(clang-tidy-14) ;;
    --wheel) packages+=(python3-wheel) ;;
    --fuzz) packages+=(clang-14 libclang-rt-14-dev) ;;
    --tsan) packages+=(clang-14 libclang-rt-14-dev libomp-14-dev) ;;
    --trilinos) packages+=(dpkg-dev xz-utils libblas-dev liblapack-dev) ;;
    *) echo "usage: $0 [--test] [--docs] [--format] [--tidy] [--wheel] [--fuzz] [--tsan] [--trilinos]" >&2; exit 1 ;;
  esac
done

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "cgcontact: this is not a Debian system. Install what these packages hold (docs/setup.md), then run cmake:" >&2
  echo "  ${packages[*]}" >&2
  exit 1
fi

installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "${packages[@]}" 2>/dev/null | sed -n 's/^installed //p' || true)
missing=()
for package in "${packages[@]}"; do
  grep -qxF -- "$package" <<<"$installed" || missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0

sudo=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "cgcontact: this needs root: become root (or install sudo) and run" >&2
    echo "  apt-get install --no-install-recommends ${missing[*]}" >&2
    exit 1
  fi
  sudo=(sudo)
fi
echo "cgcontact: installing from Debian: ${missing[*]}"
apt() { "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0 "$@"; }
install=(install --no-install-recommends "${missing[@]}")

# The package lists are fetched only when they are absent or too old to install from.
updated=no
if ! apt-get -qq --simulate "${install[@]}" >/dev/null 2>&1; then
  apt update
  updated=yes
fi
if ! apt "${install[@]}"; then
  [ "$updated" = no ] || exit 1
  apt update
  apt "${install[@]}"
fi
