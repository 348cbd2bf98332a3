#!/bin/bash
# Builds the packages of Trilinos that cgcontact uses with Kokkos' OpenMP backend, from Debian's source package, into a cache
# outside of the tree. Resumes where it was interrupted; does nothing, at once, when the cache is there.
#
#   scripts/build_trilinos_openmp.sh            build it (make trilinos-openmp)
#   scripts/build_trilinos_openmp.sh --prefix   print where it is, or would be, installed; exit code 1 if it is not there
#
# CGCONTACT_TRILINOS_CACHE   where to install (default: trilinos-13.2-openmp-<hash of options> in ~/.cache/cgcontact)
# CGCONTACT_JOBS             compilers at a time (default: one per CPU, at most one per 2 GB of free memory)
set -euo pipefail

version=13.2.0-4

# Only what cgcontact instantiates: double, int and long long on OpenMP. The rest would double the time.
options=(
  -DCMAKE_BUILD_TYPE=Release
  -DBUILD_SHARED_LIBS=ON
  -DTrilinos_ENABLE_Fortran=OFF
  -DTrilinos_ENABLE_ALL_PACKAGES=OFF
  -DTrilinos_ENABLE_ALL_OPTIONAL_PACKAGES=OFF
  -DTrilinos_ENABLE_TESTS=OFF
  -DTrilinos_ENABLE_EXAMPLES=OFF
  -DTrilinos_ENABLE_EXPLICIT_INSTANTIATION=ON
  -DTrilinos_ENABLE_OpenMP=ON
  -DKokkos_ENABLE_OPENMP=ON
  -DKokkosKernels_INST_EXECSPACE_SERIAL=OFF
  -DKokkosKernels_INST_OFFSET_INT=OFF
  -DMueLu_ENABLE_Tutorial=OFF
)
for package in Kokkos KokkosKernels Teuchos Tpetra Xpetra Belos Ifpack2 Amesos2 MueLu; do
  options+=("-DTrilinos_ENABLE_$package=ON")
done
for package in Epetra EpetraExt Thyra Stratimikos ML Zoltan Zoltan2 Galeri; do
  options+=("-DTrilinos_ENABLE_$package=OFF")
done
for library in MPI BLAS LAPACK; do options+=("-DTPL_ENABLE_$library=ON"); done
for type in DOUBLE INT_LONG_LONG OPENMP; do options+=("-DTpetra_INST_$type=ON"); done
for type in FLOAT COMPLEX_DOUBLE COMPLEX_FLOAT INT_INT INT_LONG INT_UNSIGNED INT_UNSIGNED_LONG SERIAL; do
  options+=("-DTpetra_INST_$type=OFF")
done

# KokkosKernels would pass dot products and the like to the BLAS, which here has one thread: it is to use its own loops.
# (Its CMake files have no option for that where the rest of Trilinos has a BLAS.)
edit=(sed -i '/#cmakedefine KOKKOSKERNELS_ENABLE_TPL_BLAS$/d' packages/kokkos-kernels/cmake/KokkosKernels_config.h.in)

hash=$(printf '%s\n' "$version" "${options[@]}" "${edit[@]}" | sha256sum | cut -c 1-8)
cache=${XDG_CACHE_HOME:-${HOME:-$(getent passwd "$(id -u)" | cut -d : -f 6)}/.cache}
prefix=${CGCONTACT_TRILINOS_CACHE:-$cache/cgcontact/trilinos-13.2-openmp-$hash}
complete=$prefix/complete  # written last

case "${1:-}" in
  "") ;;
  --prefix)
    echo "$prefix"
    [ -e "$complete" ] || exit 1
    exit 0 ;;
  *) echo "usage: $0 [--prefix]" >&2; exit 1 ;;
esac

say() { echo "cgcontact: $*"; }
fail() { echo "cgcontact: $*" >&2; exit 1; }
done_already() {
  [ -e "$complete" ] || return 1
  say "Trilinos with OpenMP is in $prefix"
}

! done_already || exit 0
here=$(cd "$(dirname "$0")" && pwd)
"$here/install_dependencies.sh" --trilinos

work=$prefix.build  # removed at the end
mkdir -p "$work"
exec 9>"$work/lock"
if ! flock -n 9; then
  say "another process is building $prefix: waiting for it"
  flock 9
fi
! done_already || exit 0
needed_mb=3000
free_mb=$(($(df --output=avail -k "$work" | tail -n 1) / 1024))
if [ ! -d "$work/build" ] && [ "$free_mb" -lt "$needed_mb" ]; then
  fail "$work has $free_mb MB of free space, $needed_mb are needed (CGCONTACT_TRILINOS_CACHE chooses another place)"
fi
on_exit() {
  [ -e "$complete" ] || say "not finished; the same command goes on from here ($work)" >&2
}
trap on_exit EXIT
trap "exit 130" INT TERM

# The system's own package sources of this release, as sources of source packages, in a state of our own: the system's apt is
# left as it is. apt checks the signatures.
private_apt() {
  local program=$1
  shift
  "$program" -q -o Dir::Etc::SourceList=/dev/null -o Dir::Etc::SourceParts="$work/apt/sources.list.d" \
    -o Dir::State::Lists="$work/apt/lists" -o Dir::Cache="$work/apt/cache" -o APT::Sandbox::User= \
    -o APT::Get::List-Cleanup=true "$@"
}
make_private_apt() {
  local codename
  codename=$(. /etc/os-release && echo "${VERSION_CODENAME:-none}")
  mkdir -p "$work"/apt/{sources.list.d,lists/partial,cache/archives/partial}
  { cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list 2>/dev/null || true; } |
    sed -nE 's/^[[:space:]]*deb(-src)?[[:space:]]+((\[[^]]*\][[:space:]]+)?[^[:space:]]+[[:space:]]+('"$codename"'|stable)[[:space:]](.*[[:space:]])?main([[:space:]].*)?)$/deb-src \2/p' |
    sort -u >"$work/apt/sources.list.d/cgcontact.list"
  for file in /etc/apt/sources.list.d/*.sources; do
    [ -e "$file" ] || continue
    awk -v RS= -v codename="$codename" '
      tolower($0) !~ /(^|\n)enabled:[ \t]*(no|false)/ && $0 ~ /(^|\n)Components:[^\n]*[ \t]main([ \t\n]|$)/ &&
      $0 ~ "(^|\n)Suites:[^\n]*[ \t](" codename "|stable)([ \t\n]|$)" {
        sub(/(^|\n)Types:[^\n]*/, "\nTypes: deb-src"); sub(/^\n/, ""); print $0 "\n" }' "$file"
  done >"$work/apt/sources.list.d/cgcontact.sources"
  cat "$work"/apt/sources.list.d/* | grep -q . ||
    fail "apt's sources name no Debian archive of release \"$codename\" (main): the source package cannot be fetched"
}

if [ ! -d "$work/source" ]; then
  say "fetching Debian's source package trilinos $version (166 MB)"
  make_private_apt
  private_apt apt-get update >"$work/apt/update.log" 2>&1 || true  # whether it was good enough shows next
  mkdir -p "$work/download"
  (cd "$work/download" && private_apt apt-get source --download-only "trilinos=$version" >"$work/apt/source.log" 2>&1) || {
    cat "$work/apt/update.log" "$work/apt/source.log" >&2
    fail "apt cannot fetch the source package trilinos $version (see above)"
  }
  say "unpacking"
  rm -rf "$work/unpacking"
  dpkg-source --no-check -x "$work/download/trilinos_$version.dsc" "$work/unpacking" >"$work/unpack.log" 2>&1 ||
    { tail -n 20 "$work/unpack.log" >&2; fail "dpkg-source failed (see above)"; }
  (cd "$work/unpacking" && "${edit[@]}")
  mv "$work/unpacking" "$work/source"
fi

launcher=()
if command -v ccache >/dev/null; then
  launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
fi
if [ ! -e "$work/configured" ]; then
  say "configuring"
  cmake -G Ninja "${options[@]}" "-DCMAKE_INSTALL_PREFIX=$prefix" "${launcher[@]}" \
    "-DCMAKE_PROJECT_Trilinos_INCLUDE=$here/../cmake/TrilinosUnity.cmake" -S "$work/source" -B "$work/build" \
    >"$work/configure.log" 2>&1 || { tail -n 40 "$work/configure.log" >&2; fail "cmake failed (see above)"; }
  touch "$work/configured"
fi

memory_gb=$(awk '/^MemAvailable:/ {print int($2 / 1e6)}' /proc/meminfo 2>/dev/null || true)
jobs=$(nproc)
limit=$((${memory_gb:-4} / 2))
[ "$jobs" -le "$limit" ] || jobs=$limit
[ "$jobs" -ge 1 ] || jobs=1
jobs=${CGCONTACT_JOBS:-$jobs}

# One line that is rewritten on a terminal, a line every 5 % elsewhere.
terminal=0
[ ! -t 1 ] || terminal=1
show_progress() {
  awk -v terminal="$terminal" '
    match($0, /^\[[0-9]+\/[0-9]+\]/) {
      split(substr($0, 2, RLENGTH - 2), step, "/")
      percent = int(100 * step[1] / step[2])
      text = sprintf("cgcontact: building Trilinos: %d %% (%d of %d steps)", percent, step[1], step[2])
      if (terminal) printf "\r%s", text
      else if (int(percent / 5) > int(last / 5) || last == "") print text
      last = percent
      fflush()
    }
    END { if (terminal && last != "") print "" }'
}

say "building with $jobs compilers at a time; this takes about 45 minutes of CPU time (log: $work/build.log)"
SECONDS=0
NINJA_STATUS="[%f/%t] " ninja -C "$work/build" -j "$jobs" install 2>&1 | tee "$work/build.log" | show_progress || {
  ! grep -q '^ninja: build stopped: interrupted' "$work/build.log" || exit 130
  grep -A 30 -m 1 '^FAILED' "$work/build.log" >&2 || tail -n 30 "$work/build.log" >&2
  fail "Trilinos did not build (see above)"
}
times >"$work/times"  # not in a subshell, which has times of its own
cpu=$(tail -n 1 "$work/times")
printf '%s\n' "trilinos $version" "${options[@]}" >"$prefix/options"
mv "$prefix/options" "$complete"
rm -rf "$work"
say "Trilinos with OpenMP is in $prefix ($(du -sm "$prefix" | cut -f 1) MB); last run: $((SECONDS / 60)) min, CPU (user, system): $cpu"
