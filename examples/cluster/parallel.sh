#!/bin/bash
# A sweep on all cores of one machine, or of many, by GNU Parallel. Run again, it goes on where it was.
#
#   parallel.sh [SHARDS]
set -euo pipefail
shards=${1:-8}
seq "$shards" | parallel --halt soon,fail=1 feedbits sweep part.nc --machine mill.toml --period 0.5..4/4 --feed 20..100/4 \
    --formats I8F24,I4F28,f32 --shard "{}/$shards" --quiet
files=()
for shard in $(seq "$shards"); do files+=("sweep-$shard-of-$shards.jsonl"); done
feedbits merge "${files[@]}" --out all.jsonl --report maps
