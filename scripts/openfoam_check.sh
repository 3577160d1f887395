#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Does OpenFOAM accept a case? Runs checkMesh and potentialFoam on CASE/constant/polyMesh in a folder of its own.
#
#   scripts/openfoam_check.sh CASE [--keep FOLDER] [--speed 40]
#
# CASE itself is not touched. Both programs always end with status 0, so their text decides: "Mesh OK." and a
# potential-flow solution with a finite continuity error. Patches get their conditions from their type and name:
# inlet* a fixed velocity along x, outlet* a fixed pressure, walls none through, symmetry and the like their own, other
# patches (farfield) slip, or the fixed velocity where nothing is called inlet.
# Exit: 0 both passed, 1 not, 2 wrong use, 77 OpenFOAM is not installed (Debian package `openfoam`).
set -euo pipefail

usage() {
  sed -n '3,12s/^# \{0,1\}//p' "$0" >&2
  exit 2
}

case_folder= keep= speed=40
while (($#)); do
  case $1 in
    --keep) keep=${2:?} && shift 2 ;;
    --speed) speed=${2:?} && shift 2 ;;
    -*) usage ;;
    *) [[ -z $case_folder ]] || usage; case_folder=$1; shift ;;
  esac
done
[[ -n $case_folder ]] || usage
mesh=$case_folder/constant/polyMesh
[[ -f $mesh/boundary ]] || { echo "openfoam_check: $mesh/boundary is not there" >&2; exit 2; }

for program in checkMesh potentialFoam; do
  if ! command -v "$program" >/dev/null; then
    echo "SKIPPED openfoam_check: $program is not installed (Debian package openfoam)"
    exit 77
  fi
done
# Debian puts the settings here; a sourced OpenFOAM environment comes first.
if [[ -z ${WM_PROJECT_DIR:-} ]]; then
  export WM_PROJECT_DIR=/usr/share/openfoam
fi

if [[ -n $keep ]]; then
  work=$keep
  mkdir -p "$work"
else
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
fi
mkdir -p "$work/constant/polyMesh" "$work/system" "$work/0"
for file in "$(realpath "$mesh")"/*; do  # links one by one: checkMesh adds a folder `sets`
  [[ -f $file ]] && ln -sfn "$file" "$work/constant/polyMesh/"
done

header() {  # class, object
  printf 'FoamFile { version 2.0; format ascii; class %s; object %s; }\n' "$1" "$2"
}

{
  header dictionary controlDict
  echo 'application potentialFoam; startFrom startTime; startTime 0; stopAt endTime; endTime 1; deltaT 1;'
  echo 'writeControl timeStep; writeInterval 1; writeFormat binary; writePrecision 8; runTimeModifiable false;'
} >"$work/system/controlDict"
{
  header dictionary fvSchemes
  echo 'ddtSchemes { default steadyState; }'
  echo 'gradSchemes { default leastSquares; }'
  echo 'divSchemes { default none; div(phi,U) bounded Gauss linear; div(div(phi,U)) Gauss linear; }'
  echo 'laplacianSchemes { default Gauss linear limited corrected 0.5; }'
  echo 'interpolationSchemes { default linear; }'
  echo 'snGradSchemes { default limited corrected 0.5; }'
} >"$work/system/fvSchemes"
{
  header dictionary fvSolution
  echo 'solvers { "(Phi|p)" { solver GAMG; smoother GaussSeidel; tolerance 1e-8; relTol 0.001; } }'
  echo 'potentialFlow { nNonOrthogonalCorrectors 10; PhiRefCell 0; PhiRefValue 0; pRefCell 0; pRefValue 0; }'
} >"$work/system/fvSolution"

# "name type physicalType" of each patch
patches=$(tr -d '\r' <"$mesh/boundary" | awk '
  /^[ \t]*FoamFile/ { in_header = 1 }
  in_header { if (/}/) in_header = 0; next }
  /^[ \t]*\(/ { in_list = 1; next }
  !in_list { next }
  /{/ { name = last; sub(/[ \t]*{.*/, "", $0); if ($1 != "") name = $1; type = "patch"; kind = "-"; next }
  $1 == "type" { type = $2; sub(/;.*/, "", type) }
  $1 == "physicalType" { kind = $2; sub(/;.*/, "", kind) }
  /}/ { print name, type, kind }
  NF { last = $1 }')
[[ -n $patches ]] || { echo "openfoam_check: no patches in $mesh/boundary" >&2; exit 1; }
has_inlet=$(awk 'tolower($1 $3) ~ /inlet|inflow/ { print "yes"; exit }' <<<"$patches")

condition() {  # field, name, type, kind -> one boundary condition
  local flow="type fixedValue; value uniform ($speed 0 0);" what
  what=$(tr '[:upper:]' '[:lower:]' <<<"$2 $4")
  case $3 in
    symmetry | symmetryPlane | empty | wedge | cyclic* | processor*) echo "type $3;"; return ;;
    wall) [[ $1 == U ]] && echo 'type noSlip;' || echo 'type zeroGradient;'; return ;;
  esac
  case $what in
    *inlet* | *inflow*) [[ $1 == U ]] && echo "$flow" || echo 'type zeroGradient;' ;;
    *outlet* | *outflow*) [[ $1 == U ]] && echo 'type zeroGradient;' || echo 'type fixedValue; value uniform 0;' ;;
    *) if [[ -n $has_inlet ]]; then echo 'type slip;'
       elif [[ $1 == U ]]; then echo "$flow"
       else echo 'type zeroGradient;'; fi ;;
  esac
}

field() {  # name, class, dimensions, inner value
  header "$2" "$1"
  echo "dimensions $3; internalField uniform $4; boundaryField {"
  local name type kind
  while read -r name type kind; do
    printf '%s { %s }\n' "$name" "$(condition "$1" "$name" "$type" "$kind")"
  done <<<"$patches"
  echo '}'
}
field U volVectorField '[0 1 -1 0 0 0 0]' '(0 0 0)' >"$work/0/U"
field p volScalarField '[0 2 -2 0 0 0 0]' 0 >"$work/0/p"

status=0
checkMesh -case "$work" >"$work/log.checkMesh" 2>&1 || true
grep -E '^ *(cells|faces|points|tetrahedra|boundary patches): ' "$work/log.checkMesh" || true
grep -E 'non-orthogonality|skewness =|aspect ratio =|volume ratio|\*\*\*|<<' "$work/log.checkMesh" || true
if grep -q '^ *Mesh OK\.' "$work/log.checkMesh"; then
  echo "checkMesh: Mesh OK."
else
  echo "checkMesh: FAILED"
  grep -E 'Failed .* mesh checks|FATAL|Could not' -A 4 "$work/log.checkMesh" || tail -20 "$work/log.checkMesh"
  status=1
fi

potentialFoam -case "$work" >"$work/log.potentialFoam" 2>&1 || true
error=$(sed -n 's/^Continuity error = //p' "$work/log.potentialFoam" | tail -1)
if grep -q '^End' "$work/log.potentialFoam" && [[ $error =~ ^[0-9.]+(e[-+]?[0-9]+)?$ ]] &&
  ! grep -q 'FOAM FATAL' "$work/log.potentialFoam"; then
  echo "potentialFoam: ran, continuity error $error"
else
  echo "potentialFoam: FAILED"
  grep -A 12 'FOAM FATAL' "$work/log.potentialFoam" || tail -20 "$work/log.potentialFoam"
  status=1
fi
exit $status
