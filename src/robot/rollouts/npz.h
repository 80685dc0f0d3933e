// SPDX-License-Identifier: BSD-3-Clause
// NumPy's .npz: a zip archive (PKWARE APPNOTE 6.3) of .npy arrays (NumPy enhancement proposal 1), here without
// compression, as numpy.savez writes it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace soft_robot_lab {

// An array, the last index fastest.
struct NpzArray {
  std::string name;
  std::string type;  // NumPy's: "<f8", "|b1", "<U12"
  std::vector<std::size_t> shape;
  std::string bytes;  // of all entries
};

NpzArray numbers_array(std::string name, std::vector<std::size_t> shape, const std::vector<double>& numbers);
NpzArray flags_array(std::string name, const std::vector<bool>& flags);
NpzArray words_array(std::string name, const std::vector<std::string>& words);  // UTF-8

// The archive's bytes. Throws std::invalid_argument beyond 4 GB, which this form of zip does not reach.
std::string npz(const std::vector<NpzArray>& arrays);

// Throws std::invalid_argument for what is no such archive, is compressed, cut off or damaged, has two arrays of a
// name, or arrays that share bytes.
std::vector<NpzArray> read_npz(const std::string& bytes);

// Of types <f8, <f4, <i8 and <i4; throws std::invalid_argument with the array's name for another.
std::vector<double> numbers_of(const NpzArray& array);

}  // namespace soft_robot_lab
