#!/bin/sh
# Tests the front door by itself: in a checkout that is empty but for it, on a machine where everything it calls is a
# stand-in. The real thing is exercised whenever anybody runs a command.
#
#   front_door_test.sh PATH_OF_MPMVV
set -u

front_door=$1
place=$(mktemp -d) || exit 2
trap 'rm -rf "$place"' EXIT
checkout="$place/a check out"
door="$checkout/mpmvv"
machine="$place/machine"  # the only directory on PATH while the front door runs
installed="$place/installed"
calls="$place/calls"
failures=0

# --- a machine ------------------------------------------------------------------------------------------------------

# stand_in NAME: a program of the machine, its text on standard input.
stand_in() {
  { printf '#!/bin/sh\nplace="%s"\n' "$place"; cat; } >"$machine/$1"
  chmod +x "$machine/$1"
}

# A machine with all packages, root, and a build that yields a program which tells how it was called.
set_up() {
  rm -rf "$checkout" "$machine"
  mkdir -p "$checkout" "$machine"
  cp "$front_door" "$door"
  : >"$checkout/CMakePresets.json"
  : >"$calls"
  sed -n "/^packages='/,/^'/s/^\([a-z0-9+.-]*\) .*/\1/p" "$door" >"$installed"
  for tool in sh cat cut env flock grep head mkdir nproc readlink rm sed sleep tail; do
    ln -s "$(command -v "$tool")" "$machine/$tool"
  done
  stand_in true </dev/null  # for sudo; the shell has its own
  stand_in id <<'END'
echo "${FAKE_USER:-0}"
END
  stand_in dpkg-query <<'END'
while read -r name; do echo "installed $name"; done <"$place/installed"
END
  stand_in apt-get <<'END'
echo "apt-get $*" >>"$place/calls"
[ -z "${FAKE_OFFLINE-}" ] || { echo 'E: no network' >&2; exit 100; }
case " $* " in *' install '*) for name; do echo "$name"; done >>"$place/installed" ;; esac
END
  stand_in cmake <<'END'
echo "cmake $*" >>"$place/calls"
build=build/release
case $1 in
  --preset)
    [ -z "${FAKE_BAD_CONFIGURE-}" ] || { printf -- '-- looking\nCMake Error at CMakeLists.txt:1\n' >&2; exit 1; }
    mkdir -p "$build/reports" "$build/benchmarks"
    echo "CMAKE_HOME_DIRECTORY:INTERNAL=$PWD" >"$build/CMakeCache.txt"
    : >"$build/build.ninja" ;;
  --build)
    [ -z "${FAKE_BAD_SOURCE-}" ] || { printf '[1/9] fine\nFAILED: a.o\nc++ -c a.cpp\na.cpp:1: error: what is this\n'; exit 1; }
    [ -e "$place/building" ] && echo overlap >>"$place/calls"
    : >"$place/building"
    sleep "${FAKE_BUILD_TIME:-0}"
    for program in reports/mpmvv benchmarks/mpmvv_benchmarks; do
      [ -e "$2/$program" ] && continue
      echo 'ninja explain: output a.cpp.o does not exist' >&2
      { printf '#!/bin/sh\nplace="%s"\n' "$place"; cat "$place/fake_${program##*/}"; } >"$2/$program"
      /bin/chmod +x "$2/$program"
    done
    rm "$place/building" ;;
esac
END
  stand_in ctest <<'END'
echo "ctest $*" >>"$place/calls"
echo '100% tests passed'
exit "${FAKE_VERDICT:-0}"
END
}

# The program; it takes a file of measurements for what its first line says.
cat >"$place/fake_mpmvv" <<'END'
if [ "$1" = check-performance ]; then
  what=missing
  [ -e "$2" ] && read -r what <"$2"
  case $what in current) exit 0 ;; other) exit 1 ;; esac
  echo "mpmvv: $2: $what" >&2
  exit 2
fi
echo "program in $PWD of $MPMVV_ROOT"
for a; do echo "<$a>"; done
exit ${FAKE_VERDICT:-0}
END

# The benchmarks; they write a file of measurements where they are told to.
cat >"$place/fake_mpmvv_benchmarks" <<'END'
echo "benchmarks $*" >>"$place/calls"
for a; do echo "<$a>"; done
if [ "$1" = --quick ] && [ "$2" = --json ]; then echo "${FAKE_MEASUREMENT:-current}" >"$3"; fi
echo 'last words'
exit ${FAKE_BENCHMARK:-0}
END

# --- checks ---------------------------------------------------------------------------------------------------------

# open_door ARGUMENTS: runs the front door on that machine and keeps what it said and its exit code.
open_door() {
  PATH=$machine "$door" "$@" >"$place/out" 2>"$place/err"
  code=$?
}

wrong() {
  failures=$((failures + 1))
  printf 'FAILED: %s: %s\n' "$about" "$1"
  sed 's/^/  | /' "$place/out" "$place/err"
}

expect_code() { [ "$code" -eq "$1" ] || wrong "exit code $code, not $1"; }
expect_in() { grep -qF -- "$2" "$place/$1" || wrong "no '$2' in $1"; }
expect_not_in() { ! grep -qF -- "$2" "$place/$1" || wrong "'$2' in $1"; }
expect_silence() { [ ! -s "$place/err" ] || wrong 'it was not silent'; }

# --- what it must do ------------------------------------------------------------------------------------------------

about='help needs nothing'
set_up
rm "$machine/cmake" "$machine/dpkg-query" "$machine/apt-get"
open_door --help; expect_code 0; expect_in out 'usage: ./mpmvv COMMAND'; expect_silence
open_door; expect_code 2; expect_in err 'usage: ./mpmvv COMMAND'
open_door reprot; expect_code 2; expect_in err 'unknown command: reprot'
[ ! -e "$checkout/build" ] || wrong 'something was built'

about='the first command builds, the second is silent'
set_up
open_door list; expect_code 0; expect_in err 'mpmvv: building'; expect_in calls '--target mpmvv_program'
open_door list; expect_code 0; expect_silence; expect_not_in calls apt-get
[ "$(grep -c -- --preset "$calls")" = 1 ] || wrong 'it configured again'

about='the program gets its arguments as they are, in the directory of the caller'
set_up
mkdir "$place/else where"
ln -s "$door" "$place/link"
(cd "$place/else where" && PATH=$machine ../link run 'my case.json' '*' '' --out "it's") >"$place/out" 2>"$place/err"
code=$?
expect_code 0
expect_in out "program in $place/else where of $checkout"
printf '<%s>\n' run 'my case.json' '*' '' --out "it's" >"$place/expected"
sed 1d "$place/out" | cmp -s - "$place/expected" || wrong 'the arguments are not the same'
open_door digitise fig.png --series 'a=#d62728'; expect_code 0; expect_in out '<a=#d62728>'

about="the program's exit code is the front door's"
for verdict in 0 1 2; do
  FAKE_VERDICT=$verdict open_door report; expect_code "$verdict"
done

about='a report is measured first, and told what came of it'
set_up
open_door report; expect_code 0
measurements="$checkout/reports/out/performance.json"
expect_in calls "benchmarks --quick --json $measurements --footing"; expect_in calls '--target mpmvv_program mpmvv_benchmarks'
expect_in err 'mpmvv: measuring the speed'
printf '<%s>\n' report --performance "$measurements" >"$place/expected"
sed 1d "$place/out" | cmp -s - "$place/expected" || wrong 'the arguments are not these'

about='current measurements are not repeated, others are'
open_door report; expect_silence; expect_in out "<$measurements>"
[ "$(grep -c '^benchmarks' "$calls")" = 1 ] || wrong 'it measured again'
for what in other bad; do
  echo "$what" >"$measurements"
  : >"$calls"
  open_door report; expect_code 0; expect_in calls 'benchmarks --quick'; expect_in out "<$measurements>"
done

about='earlier measurements are compared with'
mkdir -p "$checkout/benchmarks/history"
open_door report; expect_in out '<--performance-history>'; expect_in out "<$checkout/benchmarks/history>"

about='measurements lie beside the report'
for form in "--out $place/there" "--out=$place/there"; do
  set_up
  rm -rf "$place/there"
  open_door report --quick $form --threads 1; expect_code 0
  expect_in calls "benchmarks --quick --json $place/there/performance.json"
  expect_in out '<--quick>'; expect_in out "<$place/there/performance.json>"
done

about='a report without measurements is a report'
for verdict in 0 1 2; do
  set_up
  FAKE_BENCHMARK=3 FAKE_VERDICT=$verdict open_door report; expect_code "$verdict"
  expect_in err 'the speed could not be measured'
  expect_in out '<--performance-failure>'; expect_not_in out '<--performance>'
  expect_in out '<the benchmark program ended with exit code 3; its last line: last words>'
  [ ! -e "$measurements" ] || wrong 'what a failed measurement wrote is left'
done
set_up
FAKE_MEASUREMENT=nonsense open_door report; expect_code 0
expect_in out "<mpmvv: $measurements: nonsense>"; expect_not_in out '<--performance>'
set_up
: >"$checkout/reports"
open_door report; expect_code 0; expect_in out "<cannot write to $checkout/reports/out>"; expect_not_in calls '--quick --json'

about='measurements of the user are taken, and nothing is measured for bad arguments'
set_up
open_door report --performance mine.json; expect_code 0
printf '<%s>\n' report --performance mine.json >"$place/expected"
sed 1d "$place/out" | cmp -s - "$place/expected" || wrong 'the arguments are not the same'
for bad in --help --fast --out --threads; do open_door report "$bad"; expect_in out "<$bad>"; done
expect_not_in calls 'benchmarks --quick'

about='tests and benchmarks'
set_up
open_door test -L unit; expect_code 0; expect_in calls '-L unit'; expect_in out '100% tests passed'
FAKE_VERDICT=8 open_door test; expect_code 1
FAKE_VERDICT=1 open_door test; expect_code 2
open_door bench --filter 'footing/.*/1$' --quick; expect_code 0
printf '<%s>\n' --filter 'footing/.*/1$' --quick >"$place/expected"
grep '^<' "$place/out" | cmp -s - "$place/expected" || wrong 'the arguments are not the same'
FAKE_BENCHMARK=1 open_door bench --compare old.json new.json; expect_code 1

about='nearly no environment, and no standard input'
set_up
env -i PATH="$machine" LC_ALL=C "$door" list x <&- >"$place/out" 2>"$place/err"
code=$?
expect_code 0; expect_in out '<x>'

about='a checkout that was moved is configured anew'
set_up
open_door list
mv "$checkout" "$place/moved"
door="$place/moved/mpmvv"
open_door list; expect_code 0; expect_in out "of $place/moved"
[ "$(grep -c -- --preset "$calls")" = 2 ] || wrong 'it was not configured anew'
rm -rf "$place/moved"
door="$checkout/mpmvv"

about='missing packages are installed, and only those'
set_up
grep -v -e '^cmake$' -e '^libpng-dev$' "$installed" >"$place/fewer" && mv "$place/fewer" "$installed"
open_door list; expect_code 0
expect_in err 'cmake                    configures the build'
expect_not_in err 'ninja-build'
expect_in calls 'apt-get -y -q -o DPkg::Lock::Timeout=600 install --no-install-recommends cmake libpng-dev'
open_door list; expect_silence

about='no network: the command to run by hand'
set_up
: >"$installed"
FAKE_OFFLINE=yes open_door list; expect_code 2
expect_in err 'E: no network'
expect_in err 'apt-get update && apt-get install -y --no-install-recommends g++ cmake'

about='neither root nor sudo'
set_up
: >"$installed"
FAKE_USER=1000 open_door list; expect_code 2
expect_in err 'that takes root'; expect_in err 'apt-get install -y'; expect_not_in calls apt-get

about='sudo that would ask for a password'
stand_in sudo <<'END'
exit 1
END
FAKE_USER=1000 open_door list; expect_code 2; expect_in err 'that takes root'; expect_not_in calls apt-get

about='sudo that does not ask'
stand_in sudo <<'END'
[ "$1" = -n ] && shift && exec "$@"
END
FAKE_USER=1000 open_door list; expect_code 0; expect_in calls 'install --no-install-recommends g++'

about='no apt-get'
set_up
: >"$installed"
rm "$machine/apt-get"
open_door list; expect_code 2; expect_in err 'there is no apt-get here'

about='not Debian: builds with what there is'
set_up
rm "$machine/apt-get" "$machine/dpkg-query"
open_door list; expect_code 0

about='git is wanted in a git checkout, but not needed'
set_up
mkdir "$checkout/.git"
FAKE_OFFLINE=yes open_door list; expect_code 0; expect_in err 'going on without it'; expect_in out 'program in'

about='a build that cannot be configured'
set_up
FAKE_BAD_CONFIGURE=yes open_door list; expect_code 2
expect_in err 'CMake Error at'; expect_not_in err 'looking'; expect_in err 'could not be configured'

about='a build that fails'
FAKE_BAD_SOURCE=yes open_door list; expect_code 2
expect_in err 'what is this'; expect_not_in err 'fine'; expect_not_in err 'c++ -c'; expect_in err 'the build failed'
open_door list; expect_code 0

about='two at once build one after the other'
set_up
FAKE_BUILD_TIME=0.3 open_door list &
(PATH=$machine FAKE_BUILD_TIME=0.3 "$door" list) >"$place/second" 2>&1
second=$?
wait
[ "$second" -eq 0 ] || wrong "the second: exit code $second"
[ "$(grep -c -- --build "$calls")" = 2 ] || wrong 'not both have built'
expect_not_in calls overlap

[ "$failures" -eq 0 ] && echo 'The front door does what it should.'
[ "$failures" -eq 0 ]
