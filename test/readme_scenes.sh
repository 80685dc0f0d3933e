#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# readme_scenes.sh SIMULATE README...: the first example in YAML of each README is a whole scene, and converges.
set -euo pipefail
simulate=$1
shift
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for readme in "$@"; do
  awk '/^```yaml/ { inside = 1; next } /^```/ { if (inside) exit } inside' "$readme" >"$folder/scene.yaml"
  [[ -s $folder/scene.yaml ]] || { echo "$readme: no example" >&2; exit 1; }
  "$simulate" "$folder/scene.yaml" --result "$folder/result.json" || { echo "$readme: its example fails" >&2; exit 1; }
done
