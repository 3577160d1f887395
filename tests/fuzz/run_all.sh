#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# run_all.sh SECONDS [BUILD_FOLDER]: build every fuzzer with clang-14 and run each for SECONDS from fresh seeds.
# Exit status 1 where one finds something; its input is BUILD_FOLDER/finds/<fuzzer>-*. Corpora are kept between runs.
set -euo pipefail
seconds=${1:?usage: run_all.sh SECONDS [BUILD_FOLDER]}
root=$(cd "$(dirname "$0")/../.." && pwd)
build=${2:-$root/build/fuzz}
cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_COMPILER=clang++-14 -DDELFRONT_FUZZ=ON \
  > "$build.log" 2>&1 || { cat "$build.log"; exit 1; }
cmake --build "$build" --target fuzzers --parallel "$(nproc)"
mkdir -p "$build/finds"
"$build/tests/fuzz/make_seeds" "$build/seeds"
failed=0
for source in "$root"/tests/fuzz/fuzz_*.cpp; do
  name=$(basename "$source" .cpp)
  [[ -x $build/tests/fuzz/$name ]] || { echo "$name: not built, its library is missing"; continue; }
  format=${name#fuzz_}
  format=${format#read_}
  mkdir -p "$build/corpus/$format" "$build/seeds/$format"
  log="$build/finds/$name.log"
  if "$build/tests/fuzz/$name" -max_total_time="$seconds" -max_len=8192 -rss_limit_mb=1024 -timeout=10 \
    -artifact_prefix="$build/finds/$name-" "$build/corpus/$format" "$build/seeds/$format" > "$log" 2>&1; then
    echo "$name: no find; $(grep -o 'Done .*' "$log")"
  else
    echo "$name: FOUND SOMETHING, see $log"
    failed=1
  fi
done
exit $failed
