// SPDX-License-Identifier: BSD-3-Clause
// Bytes to frames and back, without any input or output; shared with the firmware, so freestanding C++14.
//
//       0      1         2        3 ..           3+n    5+n
//     +------+---------+--------+--------------+-------+      COBS: no byte is zero, so      +------------+----+
//     | kind | session | number | payload of n | CRC   |  ->  a zero ends a frame and    ->  | 6+n bytes  | 00 |
//     +------+---------+--------+--------------+-------+      nothing else does              +------------+----+
//
// CRC-16 with polynomial 0x1021, from 0xffff, not reflected (CRC-16/IBM-3740), over all before it; low byte first.
#pragma once

#include "wire.h"

namespace soft_robot_lab {
namespace wire {

constexpr uint8_t header_size = 3;
constexpr uint8_t crc_size = 2;
constexpr uint8_t max_plain = header_size + max_payload + crc_size;
constexpr uint8_t max_encoded = max_plain + 2;  // one byte of COBS, one of delimiter
constexpr uint16_t crc_start = 0xffff;

inline uint16_t crc16(const uint8_t* bytes, uint8_t count, uint16_t crc = crc_start) {
  for (uint8_t i = 0; i < count; ++i) {
    crc = static_cast<uint16_t>(crc ^ static_cast<uint16_t>(bytes[i]) << 8);
    for (uint8_t bit = 0; bit < 8; ++bit) {
      crc = static_cast<uint16_t>((crc & 0x8000) != 0 ? crc << 1 ^ 0x1021 : crc << 1);
    }
  }
  return crc;
}

struct Frame {
  uint8_t kind = 0;
  uint8_t session = no_session;
  uint8_t number = 0;
  uint8_t length = 0;  // of the payload
  uint8_t payload[max_payload] = {};
};

// Writes the frame with its delimiter; returns the number of bytes, at most max_encoded.
inline uint8_t encode(const Frame& frame, uint8_t* out) {
  uint8_t plain[max_plain] = {frame.kind, frame.session, frame.number};
  uint8_t size = header_size;
  for (uint8_t i = 0; i < frame.length; ++i) plain[size++] = frame.payload[i];
  put_u16(plain + size, crc16(plain, size));
  size = static_cast<uint8_t>(size + crc_size);

  // Each code says how far the next zero lies.
  uint8_t code_at = 0;
  uint8_t written = 1;
  for (uint8_t i = 0; i < size; ++i) {
    if (plain[i] != 0) {
      out[written++] = plain[i];
      continue;
    }
    out[code_at] = static_cast<uint8_t>(written - code_at);
    code_at = written++;
  }
  out[code_at] = static_cast<uint8_t>(written - code_at);
  out[written++] = 0;
  return written;
}

class FrameDecoder {
 public:
  // True when this byte ended a sound frame, which frame() holds until the next call.
  bool feed(uint8_t byte) {
    if (byte != 0) {
      if (size_ < max_encoded) bytes_[size_++] = byte;
      return false;
    }
    const uint8_t size = size_;
    size_ = 0;
    if (size == 0) return false;  // an idle line may send delimiters
    if (size < max_encoded && remove_cobs(size) && take(static_cast<uint8_t>(size - 1))) return true;
    ++damaged_;
    return false;
  }

  const Frame& frame() const { return frame_; }
  uint16_t damaged() const { return damaged_; }  // frames that were not sound; wraps around

 private:
  bool remove_cobs(uint8_t size) {
    uint8_t next_zero = bytes_[0];
    for (uint8_t i = 1; i < size; ++i) {
      if (i == next_zero) {
        next_zero = static_cast<uint8_t>(next_zero + bytes_[i]);
        if (next_zero <= i) return false;
        bytes_[i - 1] = 0;
      } else {
        bytes_[i - 1] = bytes_[i];
      }
    }
    return next_zero == size;
  }

  bool take(uint8_t size) {
    if (size < header_size + crc_size) return false;
    const uint8_t checked = static_cast<uint8_t>(size - crc_size);
    if (crc16(bytes_, checked) != get_u16(bytes_ + checked)) return false;
    const uint8_t length = static_cast<uint8_t>(checked - header_size);
    if (!length_fits(bytes_[0], bytes_ + header_size, length)) return false;
    frame_.kind = bytes_[0];
    frame_.session = bytes_[1];
    frame_.number = bytes_[2];
    frame_.length = length;
    for (uint8_t i = 0; i < length; ++i) frame_.payload[i] = bytes_[header_size + i];
    return true;
  }

  uint8_t bytes_[max_encoded] = {};  // since the last delimiter; longer ones are damaged
  uint8_t size_ = 0;
  uint16_t damaged_ = 0;
  Frame frame_;
};

}  // namespace wire
}  // namespace soft_robot_lab
