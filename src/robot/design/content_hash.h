// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>
#include <string>

namespace soft_robot_lab {

// FNV-1a with 128 bits (Fowler, Noll, Vo): distinguishes contents, does not resist an attacker.
class ContentHash {
 public:
  // Each piece is hashed with its length, so that moving a boundary changes the result.
  void add(const std::string& piece) {
    for (size_t length = piece.size(), i = 0; i < sizeof length; ++i, length >>= 8) add_part(length & 0xff);
    for (const char c : piece) add_part(static_cast<unsigned char>(c));
  }

  // A piece of many megabytes, by words of eight bytes: another hash than add()'s, some times as fast.
  void add_large(const std::string& piece) {
    std::uint64_t word = 0;
    std::size_t done = 0;
    for (; done + sizeof word <= piece.size(); done += sizeof word) {
      std::memcpy(&word, piece.data() + done, sizeof word);
      add_part(word);
    }
    add(piece.substr(done));
    add_part(piece.size());
  }

  std::string hex() const {
    std::string text;
    for (int shift = 124; shift >= 0; shift -= 4)
      text += "0123456789abcdef"[static_cast<unsigned>(state_ >> shift) & 15];
    return text;
  }

 private:
  __extension__ using Word = unsigned __int128;
  static constexpr Word kPrime = (Word{1} << 88) + 0x13b;

  void add_part(std::uint64_t part) { state_ = (state_ ^ part) * kPrime; }

  Word state_ = (Word{0x6c62272e07bb0142} << 64) + 0x62b821756295c58d;
};

}  // namespace soft_robot_lab
