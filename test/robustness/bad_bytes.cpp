// SPDX-License-Identifier: BSD-3-Clause
#include "bad_bytes.h"

#include <cmath>
#include <cstring>
#include <random>

namespace soft_robot_lab {
namespace {

const double kBadNumbers[] = {NAN, INFINITY, -1.0e300, 1.0e300, 1.0e-310, -1.0, 0.0};
const std::uint32_t kBadLengths[] = {0, 1, 1000, 0x7fffffff, 0xffffffff, 400000000};

template <typename Number, std::size_t count>
void add_numbers(const std::vector<std::uint8_t>& good, const Number (&numbers)[count], std::vector<BadBytes>& all) {
  for (std::size_t at = 0; at + sizeof(Number) <= good.size(); ++at)
    for (const Number number : numbers) {
      BadBytes bad{"byte " + std::to_string(at) + " on is " + std::to_string(number), good};
      std::memcpy(bad.bytes.data() + at, &number, sizeof number);
      all.push_back(std::move(bad));
    }
}

}  // namespace

std::vector<BadBytes> bad_bytes(const std::vector<std::uint8_t>& good, unsigned int seed) {
  std::vector<BadBytes> all;
  add_numbers(good, kBadNumbers, all);
  add_numbers(good, kBadLengths, all);
  for (std::size_t size = 0; size < good.size(); ++size)
    all.push_back({"cut off after " + std::to_string(size) + " bytes",
                   {good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)}});
  std::mt19937 random(seed);
  for (int i = 0; i < 200 && !good.empty(); ++i) {
    BadBytes bad{"three other bytes, " + std::to_string(i), good};
    for (int k = 0; k < 3; ++k) bad.bytes[random() % good.size()] = static_cast<std::uint8_t>(random());
    if (i % 10 == 0) bad.bytes.insert(bad.bytes.end(), 1 + random() % 100, static_cast<std::uint8_t>(random()));
    all.push_back(std::move(bad));
  }
  return all;
}

}  // namespace soft_robot_lab
