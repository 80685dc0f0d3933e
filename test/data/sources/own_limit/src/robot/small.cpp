// SPDX-License-Identifier: BSD-3-Clause
constexpr unsigned kLargestFile_bytes = 1u << 30;
