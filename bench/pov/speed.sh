#!/bin/sh
# SPDX-License-Identifier: MIT OR Apache-2.0
# Races Dioptric against POV-Ray on the Standard Procedural Databases, in turns, and prints the ratios as Markdown
# tables: one ray a pixel, and anti-aliased so that our pictures are at least as near to their limit as POV-Ray's.
#
#   bench/pov/speed.sh [DATA [OUT]]
#
# Needs POV-Ray, and python3 for the anti-aliased half (its standard library is enough). DATA is the folder with
# balls.nff, balls.pov, ... ; OUT keeps pictures and figures (without it they are thrown away), and the pictures of 256
# samples in it are used again. DIOPTRIC names the program, SIZE the side of the pictures in pixels (1024), THREADS their
# number for both (2), ROUNDS how many times each runs in turn (5), SCENES which scenes, MODES which halves (none
# adaptive), ADAPTIVE our settings (without it the cheapest below that are good enough, for each scene). The whole takes
# about eight minutes, a few more where the pictures of 256 samples are not there yet.
#
# Equal work: POV-Ray gets the scenes as `level` (level.sh) makes them, without what NFF cannot say, so that both
# programs follow the same rays; their counts stand in the table. What is raced is POV-Ray's printed trace time against
# the render seconds of our --stats, and its parse and bounding time against our read and compile seconds. POV-Ray's
# waits between these are not counted.
#
# Equal quality: POV-Ray runs with +A0.3, its default (one ray a pixel, nine more where neighbours differ by 0.3,
# jittered). The error of each is the root mean square difference from its own picture of 256 samples a pixel, over
# BANDS bands of eight rows. POV-Ray takes at most 81 samples a pixel, so that its reference is rendered at twice the
# size with 64 (+A0.0 +R8 -J) and averaged. Of the settings in `candidates` each scene gets the one that casts the
# fewest rays with an error no larger than POV-Ray's.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
. "$root/bench/pov/level.sh"
data=$(cd "${1:-$root/../shared/data/spd}" && pwd)
dioptric=${DIOPTRIC:-$root/target/release/dioptric}
size=${SIZE:-1024} threads=${THREADS:-2} rounds=${ROUNDS:-5} bands=${BANDS:-4}
scenes=${SCENES:-balls gears rings teapot tree} modes=${MODES:-none adaptive}
# First samples, most samples, threshold.
candidates='1,5,0.05 1,6,0.05 1,6,0.07 1,6,0.1 1,7,0.07 1,7,0.1 1,7,0.15 1,8,0.07 1,8,0.1 1,8,0.15 1,8,0.2 1,9,0.15 1,9,0.2
    1,10,0.1 1,10,0.2 1,12,0.05 1,12,0.2 2,8,0.2 2,16,0.05 4,64,0.05'

need_povray speed.sh
case $modes in *adaptive*)
    command -v python3 > /dev/null || { echo "speed.sh: python3 is not here; MODES=none goes without it" >&2; exit 1; }
    ;;
esac
[ -x "$dioptric" ] || (cd "$root" && cargo build --release)

if [ $# -ge 2 ]; then
    mkdir -p "$2"
    out=$(cd "$2" && pwd)
else
    out=$(mktemp -d)
    trap 'rm -rf "$out"' EXIT
fi
cd "$out"

# pov SCENE FILE SIDE OPTIONS...: writes FILE.ppm (16 bits, no gamma) and FILE.log
pov() (
    scene=$1 file=$2 side=$3
    shift 3
    povray "+I$scene.pov" "+O$file.ppm" "+W$side" "+H$side" +FP16 -D "+WT$threads" "$@" > "$file.raw" 2>&1 ||
        { cat "$file.raw" >&2; exit 1; }
    tr '\r' '\n' < "$file.raw" | grep -v '^Rendered' > "$file.log"
    rm "$file.raw"
)
# ours SCENE FILE OPTIONS...: writes FILE.png (16 bits) and FILE.json
ours() (
    scene=$1 file=$2
    shift 2
    "$dioptric" render "$data/$scene.nff" --size "${size}x$size" --bits 16 --threads "$threads" --quiet \
        --output "$file.png" --stats "$file.json" "$@"
)
# A count of POV-Ray's report: the number behind "$1" in file $2.
count() { sed -n "s/.*$1: *\([0-9]*\).*/\1/p" "$2" | head -n 1; }
note() { echo "$1 $2 $3 $4 $5" >> figures; }
median() {
    awk -v a="$1" -v b="$2" -v c="$3" -v d="$4" '$1 == a && $2 == b && $3 == c && $4 == d { print $5 }' figures |
        sort -n | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'
}

# The files of a scene's band number $2, and its top row.
band() { echo "$1-band$2"; }
top() { echo $((size * (2 * $1 + 1) / (2 * bands) - 4)); }
# The root mean square error of picture $1 against $2, squared.
square() (
    "$dioptric" compare "$1" "$2" --json > compared.json || [ $? = 1 ]
    number rmse compared.json | awk '{ print $1 * $1 }'
)
# Our picture of all bands of scene $1 with settings $2, as its error and its rays.
try() {
    for i in $(seq 0 $((bands - 1))); do
        ours "$1" tried --antialias adaptive $2 --crop "0,$(top "$i"),$size,8"
        echo "$(square tried.png "$(band "$1" "$i")-ours256.png") $(number total tried.json)"
    done | awk '{ sum += $1; rays += $2; n++ } END { printf "%.6f %d\n", sqrt(sum / n), rays }'
}
settings() { echo "$1" | awk -F, '{ print "--samples", $1, "--max-samples", $2, "--threshold", $3 }'; }
# Notes the errors of both programs, and our settings in SCENE.settings.
settle() {
    pov "$1" "$1-adaptive" "$size" +A0.3
    for i in $(seq 0 $((bands - 1))); do
        name=$(band "$1" "$i") top=$(top "$i")
        if [ ! -e "$name-pov256.png" ]; then
            pov "$1" "$name" $((2 * size)) +A0.0 +R8 -J "+SR$((2 * top + 1))" "+ER$((2 * top + 16))"
            python3 "$root/bench/pov/average.py" "$name.ppm" 2 "$top" 8 "$name-pov256.png"
            rm "$name.ppm"
        fi
        [ -e "$name-ours256.png" ] || ours "$1" "$name-ours256" --antialias grid --samples 256 --crop "0,$top,$size,8"
        python3 "$root/bench/pov/average.py" "$1-adaptive.ppm" 1 "$top" 8 "$name-pov.png"
        square "$name-pov.png" "$name-pov256.png"
    done | awk '{ sum += $1; n++ } END { printf "%.6f\n", sqrt(sum / n) }' > "$1.limit"
    note "$1" adaptive pov rmse "$(cat "$1.limit")"
    if [ -n "${ADAPTIVE:-}" ]; then
        echo "$ADAPTIVE" > "$1.settings"
    else
        for candidate in $candidates; do
            echo "$(try "$1" "$(settings "$candidate")") $candidate"
        done | tee "$1.tried" | awk -v limit="$(cat "$1.limit")" '$1 <= limit && (!least || $2 < least) { least = $2; best = $3 }
            END { print best }' > "$1.best"
        [ -s "$1.best" ] || { echo "speed.sh: none of our settings is as good as POV-Ray on $1" >&2; exit 1; }
        settings "$(cat "$1.best")" > "$1.settings"
    fi
    note "$1" adaptive ours rmse "$(try "$1" "$(cat "$1.settings")" | cut -d' ' -f1)"
}

: > figures
for scene in $scenes; do level "$data/$scene" > "$scene.pov"; done
case $modes in *adaptive*) for scene in $scenes; do settle "$scene"; done ;; esac
for mode in $modes; do
    for scene in $scenes; do
        name=$scene-$mode
        round=0
        while [ $round -lt "$rounds" ]; do
            round=$((round + 1))
            # Each twice, of which the second run counts: a virtual machine gives idle memory back to its host, and who
            # touches it first waits for it, 90 ms for a film of 84 MB.
            if [ "$mode" = none ]; then
                for _ in 1 2; do pov "$scene" "$name" "$size" -A; done
                for _ in 1 2; do ours "$scene" "$name" --antialias none; done
            else
                for _ in 1 2; do pov "$scene" "$name" "$size" +A0.3; done
                for _ in 1 2; do ours "$scene" "$name" --antialias adaptive $(cat "$scene.settings"); done
            fi
            note "$scene" "$mode" pov trace "$(seconds Trace "$name.log")"
            note "$scene" "$mode" pov ready "$(awk "BEGIN { print $(seconds Parse "$name.log") + $(seconds Bounding "$name.log") }")"
            note "$scene" "$mode" ours trace "$(number render "$name.json")"
            note "$scene" "$mode" ours ready "$(awk "BEGIN { print $(number read "$name.json") + $(number compile "$name.json") }")"
        done
        note "$scene" "$mode" pov rays "$(count Rays "$name.log")"
        note "$scene" "$mode" pov shadow "$(count 'Shadow Ray Tests' "$name.log")"
        note "$scene" "$mode" ours rays "$(($(number total "$name.json") - $(number shadow "$name.json")))"
        note "$scene" "$mode" ours shadow "$(number shadow "$name.json")"
    done
done

echo "$size x $size, $threads threads, medians of $rounds pairs of runs in turn, of which the second counts; POV-Ray 3.7 with the levelled scenes."
for mode in $modes; do
    echo
    if [ "$mode" = none ]; then
        echo "One ray a pixel: \`-A\` and \`--antialias none\`."
    else
        echo "Anti-aliased: \`+A0.3\` and \`--antialias adaptive\` with the settings in the last column (first samples of a pixel,"
        echo "most samples, threshold), the cheapest with no larger error; errors are against each program's own 256 samples."
    fi
    echo
    echo "| scene | POV-Ray traces, s | Dioptric renders, s | **ratio** | POV-Ray: rays + shadow rays, million | Dioptric | POV-Ray parses and bounds, s | Dioptric reads and compiles | ratio |$([ "$mode" = none ] || echo ' error of POV-Ray | of Dioptric | settings |')"
    echo "|---|---|---|---|---|---|---|---|---|$([ "$mode" = none ] || echo '---|---|---|')"
    for scene in $scenes; do
        of() { median "$scene" "$mode" "$1" "$2"; }
        awk -v scene="$scene" -v pt="$(of pov trace)" -v ot="$(of ours trace)" -v pr="$(of pov rays)" -v or="$(of ours rays)" \
            -v ps="$(of pov shadow)" -v os="$(of ours shadow)" -v pc="$(of pov ready)" -v oc="$(of ours ready)" 'BEGIN {
                printf "| %s | %.3f | %.3f | **%.2f** | %.2f + %.2f | %.2f + %.2f | %.3f | %.3f | %.2f |", scene, pt, ot,
                    pt / ot, pr / 1e6, ps / 1e6, or / 1e6, os / 1e6, pc, oc, pc / oc }'
        [ "$mode" = none ] || printf ' %s | %s | %s |' "$(of pov rmse)" "$(of ours rmse)" \
            "$(sed 's/--[a-z-]* *//g; s/ /, /g' "$scene.settings")"
        echo
    done
    for scene in $scenes; do
        echo "$(median "$scene" "$mode" pov trace) $(median "$scene" "$mode" ours trace)"
    done | awk '{ sum += log($1 / $2); n++ } END { printf "\nGeometric mean of the ratios: **%.2f**\n", exp(sum / n) }'
done
