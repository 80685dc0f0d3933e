#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# library_count.sh PROGRAM MOST: ends with 1 where PROGRAM loads more than MOST libraries beside the C and C++ runtime's and ROS's.
set -euo pipefail
runtime='linux-vdso|ld-linux|libc\.so|libm\.so|libdl\.so|libpthread\.so|librt\.so|libgcc_s|libstdc\+\+'
ros='libros|libxmlrpcpp|libcpp_common|libtf2|libmessage_filters|libclass_loader|libactionlib|libtopic_tools|libdiagnostic'
others=$(ldd "$1" | awk '{print $1}' | sed 's|.*/||' | grep -vE "^($runtime|$ros)" | sort)
count=$(wc -l <<<"$others")
echo "$(basename "$1"): $count libraries of others, at most $2:" $others
((count <= $2))
