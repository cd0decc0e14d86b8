#!/bin/sh
# SPDX-License-Identifier: MIT OR Apache-2.0
# Casts the same rays with Embree and with Dioptric, in turns, and prints how fast each was, how long each built, and
# whether they hit the same, as Markdown tables.
#
#   bench/embree/run.sh [OUT]
#   bench/embree/run.sh --large [OUT]     ten million triangles: build seconds, rays and the most memory of each
#
# OUT keeps the scenes, rays, hits and every figure (without it they are thrown away). DIOPTRIC names the program, ROUNDS
# how many times each program runs in turn (5), REPEAT how often it casts all rays in a run (3), COUNT the triangles and
# spheres (1000000), SIDE the side of the pictures that the primary rays make (720), SCENES which scenes (closed terrain
# spheres), THREADS which numbers of threads ("1 2"). The whole takes about seven minutes.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
here=$root/bench/embree
dioptric=${DIOPTRIC:-$root/target/release/dioptric}
large=
[ "${1:-}" != --large ] || { large=yes; shift; }
rounds=${ROUNDS:-5} repeat=${REPEAT:-3} side=${SIDE:-720} threads=${THREADS:-1 2}
count=${COUNT:-$([ -z "$large" ] && echo 1000000 || echo 10000000)}
scenes=${SCENES:-$([ -z "$large" ] && echo closed terrain spheres || echo closed)}

if [ ! -e /usr/include/embree3/rtcore.h ] || ! command -v g++ > /dev/null; then
    if [ "$(id -u)" != 0 ] || ! command -v apt-get > /dev/null; then
        echo "run.sh: Embree 3 and a C++ compiler are not here; as root on Debian: apt-get install libembree-dev g++" >&2
        exit 1
    fi
    apt-get install -y libembree-dev g++ > /dev/null
fi
[ -x "$dioptric" ] || (cd "$root" && cargo build --release)

if [ $# -ge 1 ]; then
    mkdir -p "$1"
    out=$(cd "$1" && pwd)
else
    out=$(mktemp -d)
    trap 'rm -rf "$out"' EXIT
fi
cd "$out"
g++ -O3 -march=native -ffp-contract=off -o generate "$here/generate.cpp" -lembree3
g++ -O3 -march=native -pthread -o embree "$here/embree.cpp" -lembree3

for scene in $scenes; do
    ./generate "$scene" "$count" "$side" "$scene"
done

# The words of a program's report: `build 0.123 s` and `median 1.23 Mrays/s (...)`.
build_of() { sed -n 's/.*build[^0-9]*\([0-9.]*\) s.*/\1/p' "$1" | head -n 1; }
median_of() { sed -n 's/.*median \([0-9.]*\) Mrays.*/\1/p' "$1"; }
# Runs "$@", which is the program $1 doing $2, and notes its figures as lines `build|rays CELL PROGRAM VALUE`.
note() {
    cell=$1 program=$2
    shift 2
    "$@" > report 2>&1 || { cat report >&2; exit 1; }
    [ -n "$(median_of report)" ] || { echo "run.sh: no median in what $program printed:" >&2; cat report >&2; exit 1; }
    echo "rays $cell $program $(median_of report)" >> figures
    echo "build ${cell%%/*}/${cell##*/} $program $(build_of report)" >> figures
    sed -n "s#^peak \(.*\) MiB#peak $cell $program \1#p" report >> figures
}
ours() {
    note "$1/$2/$3/$4" dioptric $5 "$dioptric" trace "$1.ply" "$1-$2.rays" -o "$1-$2-$3.dioptric" --threads "$4" \
        --repeat "$repeat" $(case $3 in any) echo --any ;; packet) echo --batch ;; esac)
}
theirs() { note "$1/$2/$3/$4" embree $5 ./embree trace "$1.ply" "$1-$2.rays" "$4" "$repeat" "$3" "$1-$2-$3.embree"; }
# The median, least and most of the figures of a kind, cell and program.
figures_of() {
    awk -v kind="$1" -v cell="$2" -v program="$3" '$1 == kind && $2 == cell && $3 == program { print $4 }' figures |
        sort -n | awk '{ v[NR] = $1 } END { if (NR) print v[int((NR + 1) / 2)], v[1], v[NR] }'
}
over() { awk "BEGIN { printf \"%.2f\", $1 / $2 }"; }

: > figures
queries='closest any'
[ -z "$large" ] || { queries=closest rounds=1; }
for scene in $scenes; do
    for rays in primary bounce; do
        for thread in $threads; do
            round=0
            while [ $round -lt "$rounds" ]; do
                round=$((round + 1))
                for query in $queries; do
                    ours "$scene" "$rays" "$query" "$thread" "${large:+./embree peak}"
                    theirs "$scene" "$rays" "$query" "$thread" "${large:+./embree peak}"
                done
                [ -n "$large" ] || {
                    ours "$scene" "$rays" packet "$thread" ""
                    theirs "$scene" "$rays" packet "$thread" ""
                }
            done
        done
    done
done

echo "$count triangles or spheres a scene, $side x $side primary rays and a cosine-distributed one from each hit; medians"
echo "(least to most) of $rounds runs in turn, each the median of $repeat times all rays. $(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -n 1)."
echo
echo "| scene | rays | query | threads | Dioptric, Mrays/s | Embree, single rays | ratio | packets: Dioptric \`--batch\` | Embree, 16 |"
echo "|---|---|---|---|---|---|---|---|---|"
for scene in $scenes; do
    for rays in primary bounce; do
        for query in $queries; do
            for thread in $threads; do
                a=$(figures_of rays "$scene/$rays/$query/$thread" dioptric)
                b=$(figures_of rays "$scene/$rays/$query/$thread" embree)
                p= q=
                [ "$query" != closest ] || {
                    p=$(figures_of rays "$scene/$rays/packet/$thread" dioptric)
                    q=$(figures_of rays "$scene/$rays/packet/$thread" embree)
                }
                printf '| %s | %s | %s | %s | %s (%s to %s) | %s (%s to %s) | **%s** | %s | %s |\n' "$scene" "$rays" \
                    "$query" "$thread" $a $b "$(over "${a%% *}" "${b%% *}")" "${p%% *}" "${q%% *}"
            done
        done
    done
done

echo
echo "| scene | threads | Dioptric builds, s | Embree builds, s | Embree's over ours |"
echo "|---|---|---|---|---|"
for scene in $scenes; do
    for thread in $threads; do
        a=$(figures_of build "$scene/$thread" dioptric) b=$(figures_of build "$scene/$thread" embree)
        printf '| %s | %s | %s (%s to %s) | %s (%s to %s) | %s |\n' "$scene" "$thread" $a $b "$(over "${b%% *}" "${a%% *}")"
    done
done

if [ -n "$large" ]; then
    echo
    echo "| scene | rays | threads | Dioptric's most memory, MiB | Embree's |"
    echo "|---|---|---|---|---|"
    for scene in $scenes; do
        for rays in primary bounce; do
            for thread in $threads; do
                a=$(figures_of peak "$scene/$rays/closest/$thread" dioptric)
                b=$(figures_of peak "$scene/$rays/closest/$thread" embree)
                echo "| $scene | $rays | $thread | ${a%% *} | ${b%% *} |"
            done
        done
    done
elif [ "$threads" = '1 2' ]; then
    echo
    echo "| scene | rays | query | Dioptric: two threads over one | Embree |"
    echo "|---|---|---|---|---|"
    for scene in $scenes; do
        for rays in primary bounce; do
            for query in $queries; do
                for program in dioptric embree; do
                    one=$(figures_of rays "$scene/$rays/$query/1" $program)
                    two=$(figures_of rays "$scene/$rays/$query/2" $program)
                    over "${two%% *}" "${one%% *}" > "faster.$program"
                done
                echo "| $scene | $rays | $query | $(cat faster.dioptric) | $(cat faster.embree) |"
            done
        done
    done
fi

# The hits of the last round: distances for the closest, yes or no for any.
echo
echo "Hits, Dioptric's and Embree's; two differ where one hits and one does not, or by more than 1e-4 of the distance:"
echo
for scene in $scenes; do
    for rays in primary bounce; do
        for query in $queries; do
            echo "- $scene, $rays, $query: $(./embree compare "$scene.ply" "$scene-$rays.rays" "$query" \
                "$scene-$rays-$query.dioptric" "$scene-$rays-$query.embree")"
        done
    done
done
