// SPDX-License-Identifier: BSD-3-Clause
#include "robot/rollouts/npz.h"

#include <gtest/gtest.h>

#include "fuzz_npz.h"
#include "fuzz_rules.h"

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace soft_robot_lab {
namespace {

std::string archive() {
  return npz({numbers_array("commands", {2, 3}, {1.0, 2.0, 3.0, -4.5, 1e-300, 6.0}), flags_array("good", {true, false}),
              words_array("names", {"left", "right_2"}), numbers_array("empty", {0, 3}, {})});
}

std::string refusal(const std::string& bytes) {
  try {
    for (const NpzArray& array : read_npz(bytes)) numbers_of(array);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Npz, GivesBackWhatWasWritten) {
  const std::vector<NpzArray> arrays = read_npz(archive());
  ASSERT_EQ(arrays.size(), 4u);
  EXPECT_EQ(arrays[0].name, "commands");
  EXPECT_EQ(arrays[0].shape, (std::vector<std::size_t>{2, 3}));
  EXPECT_EQ(numbers_of(arrays[0]), (std::vector<double>{1.0, 2.0, 3.0, -4.5, 1e-300, 6.0}));
  EXPECT_EQ(arrays[1].bytes, std::string("\1\0", 2));
  EXPECT_EQ(arrays[2].type, "<U7");
  EXPECT_EQ(arrays[2].bytes.substr(4 * 7, 8), std::string("r\0\0\0i\0\0\0", 8));
  EXPECT_EQ(arrays[3].shape, (std::vector<std::size_t>{0, 3}));
}

TEST(Npz, IsTheSameFileForTheSameArrays) { EXPECT_EQ(archive(), archive()); }

TEST(Npz, RefusesAnArchiveThatIsCutOffAnywhere) {
  const std::string whole = archive();
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_NE(refusal(whole.substr(0, size)), "") << size << " of " << whole.size();
}

TEST(Npz, ReadsOrRefusesAnArchiveWithAnyByteChanged) {
  for (std::size_t at = 0; at < archive().size(); ++at)
    for (const char other : {'\0', '\xff', '1'}) {
      std::string changed = archive();
      changed[at] = other;
      refusal(changed);  // under sanitisers: no byte is read that is not there
    }
}

TEST(Npz, NamesWhatItDoesNotRead) {
  EXPECT_NE(refusal("no archive").find("numpy.savez"), std::string::npos);
  const auto with = [](const std::string& from, const std::string& to) {
    std::string bytes = npz({numbers_array("a", {2, 2}, {1, 2, 3, 4})});
    return refusal(bytes.replace(bytes.find(from), from.size(), to));
  };
  EXPECT_NE(with("'fortran_order': False", "'fortran_order': True ").find("Fortran"), std::string::npos);
  EXPECT_NE(refusal(npz({{"a", "<c8", {2}, std::string(16, '\0')}})).find("a is of type <c8"), std::string::npos);
  std::string compressed = archive();
  compressed[compressed.rfind("PK\x01\x02") + 10] = 8;
  EXPECT_NE(refusal(compressed).find("compressed"), std::string::npos);
  std::string encrypted = archive();
  encrypted[encrypted.rfind("PK\x01\x02") + 8] |= 1;
  EXPECT_NE(refusal(encrypted).find("encrypted"), std::string::npos);
  EXPECT_EQ(with("NUMPY\x01", "NUMPY\x09"), "npz: a is of version 9 of NumPy's format, must be 1, 2 or 3");
  EXPECT_EQ(with("'shape': (2, 2, )", "'shape': (2, 1, )"), "npz: a holds more numbers than its shape says");
  EXPECT_EQ(with("(2, 2, ), }" + std::string(17, ' '), "(2, 2, ), 'shape': (4, ), }" + std::string(1, ' ')),
            "npz: an array's header has shape twice");
}

// NumPy calls both the file b.npy and the file b by the name b.
TEST(Npz, RefusesTwoArraysOfOneName) {
  std::string bytes = npz({numbers_array("b", {2}, {1, 2}), numbers_array("b2345", {2}, {3, 4})});
  const auto rename = [&](std::size_t name_size_at, std::size_t name_at) {
    bytes[name_size_at] = 1;
    bytes.erase(name_at + 1, 8);
  };
  const std::size_t file = bytes.rfind("PK\x03\x04");
  rename(file + 26, file + 30);
  const std::size_t row = bytes.rfind("PK\x01\x02"), directory = bytes.find("PK\x01\x02");
  rename(row + 28, row + 46);
  const std::size_t end = bytes.rfind("PK\x05\x06");
  bytes[end + 16] = static_cast<char>(directory & 0xff);
  bytes[end + 17] = static_cast<char>(directory >> 8);
  EXPECT_EQ(refusal(bytes), "npz: b stands twice in the directory");
}

TEST(Npz, RefusesADamagedArray) {
  std::string damaged = archive();
  damaged[damaged.find("\x93NUMPY") + 130] ^= 1;  // in the first array's numbers
  EXPECT_EQ(refusal(damaged), "npz: commands is damaged: its checksum is another");
}

// An archive of two arrays of the same length, changed.
std::string two_arrays(const std::function<void(std::string&, std::size_t, std::size_t)>& change) {
  std::string bytes = npz({numbers_array("a", {2}, {1, 2}), numbers_array("b", {2}, {3, 4})});
  change(bytes, bytes.find("PK\x01\x02"), bytes.rfind("PK\x01\x02"));
  return refusal(bytes);
}

TEST(Npz, RefusesArraysThatShareBytesOrNames) {
  EXPECT_EQ(two_arrays([](std::string& bytes, std::size_t first, std::size_t second) {
              bytes.replace(second, 46, bytes, first, 46);  // the same place, checksum and sizes
            }),
            "npz: b.npy has another name where its numbers stand");
  EXPECT_EQ(two_arrays([](std::string& bytes, std::size_t first, std::size_t second) {
              bytes.replace(second, 51, bytes, first, 51);
            }),
            "npz: a.npy stands twice in the directory");
  EXPECT_EQ(two_arrays([](std::string& bytes, std::size_t first, std::size_t) { bytes[first + 24] = '\xff'; }),
            "npz: b.npy begins within another array");
  EXPECT_EQ(two_arrays([](std::string& bytes, std::size_t, std::size_t) { bytes[bytes.size() - 12] = 1; }),
            "npz: its directory has another number of arrays than it says");
  EXPECT_EQ(two_arrays([](std::string& bytes, std::size_t, std::size_t) { bytes[bytes.size() - 12] = 3; }),
            "npz: its directory is broken");
}

TEST(Npz, KeepsNamesInUtf8) {
  const std::vector<NpzArray> arrays = read_npz(npz({words_array("n\u00e4me", {"\u00e4rm", "\U0001f600", "a"})}));
  EXPECT_EQ(arrays[0].name, "n\u00e4me");
  EXPECT_EQ(arrays[0].type, "<U3");
  EXPECT_EQ(arrays[0].bytes.substr(0, 8), std::string("\xe4\0\0\0r\0\0\0", 8));
  EXPECT_EQ(arrays[0].bytes.substr(12, 8), std::string("\0\xf6\1\0\0\0\0\0", 8));
}

TEST(Npz, SurvivesTheFuzzersCorpusAndItsLike) {
  EXPECT_EQ(run_corpus(SOFT_ROBOT_LAB_SOURCE "/test/data/fuzz/npz", fuzz_npz, 300), 3);
}

}  // namespace
}  // namespace soft_robot_lab
