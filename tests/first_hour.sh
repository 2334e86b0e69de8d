#!/usr/bin/env bash
# A newcomer's first hour with the program that is named as the argument: start a project, make three mistakes, repair
# them by what the messages say, then test, vary, draw, calibrate, diagnose and optimize. Ends at the first surprise.
set -euo pipefail
program="$(realpath "$1")"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
unset MODELICAPATH

mocc() { "$program" "$@"; }
surprise() {
  echo "surprise: $1" >&2
  exit 1
}
# The command must end with this status; what it says is kept in `said`.
expect() {
  local status="$1" found=0
  shift
  "$@" >said 2>&1 || found=$?
  [ "$found" = "$status" ] || { cat said >&2; surprise "status $found, not $status: $*"; }
}
says() { grep -qF -- "$1" said || { cat said >&2; surprise "it does not say: $1"; }; }

echo "-- a project that runs"
expect 0 mocc new gripper
cd gripper
expect 0 mocc simulate gripper.mol
says "wrote gripper.csv, gripper.svg"
expect 0 mocc test
expect 2 mocc new .
expect 2 mocc simulate griper.mol

echo "-- three mistakes, repaired by the messages"
cp gripper.mol good.txt
sed -i 's/spool(m = 0.03/spool(mass = 0.03/; s/connect(magnet.flange, spool.flange)/connect(magnet.flange, spol.flange)/; s/C_edge    = 2e-8 "Control edge, fully open";/C_edge    = 2e-8 "Control edge, fully open"/' gripper.mol
repairs=0
for round in 1 2 3 4; do
  mocc check gripper.mol >said 2>&1 && break
  if grep -q "expected .*;" said; then
    says "error[MO0"
    sed -i 's/\("Control edge, fully open"\)$/\1;/' gripper.mol
  else
    # `did you mean` names the word to write instead of the one in the message.
    grep -q "spol" said && { says "did you mean \`spool\`"; sed -i 's/spol\./spool./' gripper.mol; }
    grep -q "mass" said && sed -i 's/spool(mass = /spool(m = /' gripper.mol
  fi
  repairs=$((repairs + 1))
done
cmp gripper.mol good.txt || surprise "the messages have not led back to the model"
[ "$repairs" -ge 1 ] || surprise "there was nothing to repair"

echo "-- tests that notice a change"
sed -i 's/^# traces/traces/' gripper.test.toml
expect 1 mocc test
expect 0 mocc test --update
expect 0 mocc test
sed -i 's/F_magnet  = 25 /F_magnet  = 26 /' gripper.mol
expect 1 mocc test
cp good.txt gripper.mol
expect 0 mocc test --quiet
[ ! -s said ] || surprise "--quiet speaks"

echo "-- a sweep and pictures"
expect 0 mocc sweep gripper.mol --vary p_supply=3e5:9e5:4 --vary F_magnet=22,25,28 \
  --measure "t_open = when(s > 2.9e-3)" --output sweep.csv
[ "$(wc -l <sweep.csv)" = 13 ] || surprise "not 12 runs"
expect 0 mocc plot sweep.csv --x p_supply --y t_open --by F_magnet --output sweep.svg
[ "$(grep -c "F_magnet = " sweep.svg)" -ge 1 ] || surprise "no legend"
expect 0 mocc plot gripper.csv --x s --y p --output over.svg
expect 2 mocc plot gripper.csv --output over.pdf
mocc simulate - --output - --quiet <gripper.mol 2>/dev/null | mocc plot - --output piped.svg
expect 0 mocc report gripper.mol --quiet
expect 0 mocc doc gripper.mol -o pages --quiet
expect 0 mocc simulate gripper.mol --explain-start --quiet --output start.csv
says "fixed: start values that the model requires"

echo "-- parameters, effects and a design"
expect 0 mocc calibrate gripper.toml --no-profiles --out fit
says "converged"
expect 0 mocc simulate fit/gripper_calibrated.mol --output fitted.csv
expect 0 mocc diagnose gripper.toml --out diagnosis
expect 0 test -s diagnosis/diagnosis.html
cat >design.toml <<'PLAN'
model = "gripper.mol"
starts = 2
[goal]
minimize = "t_open = when(s > 2.9e-3)"
[limits]
v = { is = "at(spool.v, when(s > 2.9e-3))", max = "1.2 m/s" }
[free]
F_magnet = { min = 20, max = 40 }
PLAN
expect 0 mocc optimize design.toml
says "limit v"
echo "-- the first hour holds no surprise"
