#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# check_format.sh CLANG_FORMAT ROOT: names every source that .clang-format would change, and ends with 1 where there is one.
set -euo pipefail
cd "$2"
find src include test -name '*.h' -o -name '*.cpp' | grep -v '^test/data/' | xargs -P2 -n 50 "$1" --dry-run -Werror
