# One run: sh plate.sh DIAMETER WIDTH LENGTH THICKNESS FORCE, beside plate.inp
set -e
awk -v d="$1" -v w="$2" -v l="$3" -f mesh.awk > mesh.inp
awk -v w="$2" -v t="$4" -v f="$5" \
    'BEGIN { printf "*DLOAD\nEND, P2, %.12g\n", -f / (w * t) }' > load.inp
ccx plate
