// SPDX-License-Identifier: BSD-3-Clause
#include "link.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "words.h"

namespace soft_robot_lab {
namespace {

constexpr double greeting_period_s = 0.05;

std::uint8_t next_session(std::uint8_t session) {
  return session == 255 ? std::uint8_t{1} : static_cast<std::uint8_t>(session + 1);
}

}  // namespace

Link::Link(LinkOptions options, std::uint16_t configuration_crc, OpenPort open_port)
    : options_(options),
      configuration_crc_(configuration_crc),
      open_port_(std::move(open_port)),
      session_(options.first_session) {
  times_.backoff_s = options_.first_backoff_s;
  if (session_ == wire::no_session) session_ = 1;
}

std::vector<LinkEvent> Link::update(double now_s) {
  times_.now_s = now_s;
  try {
    if (!port_) {
      try_to_open(now_s);
    } else {
      receive(now_s);
      keep_up(now_s);
    }
  } catch (const PortError& error) {
    lose(error.what(), now_s);
  }
  return std::exchange(events_, {});
}

void Link::try_to_open(double now_s) {
  if (now_s < times_.attempt_s) return;
  port_ = open_port_();
  decoder_ = {};
  damaged_before_ = 0;
  state_ = State::greeting;
  session_ = next_session(session_);
  times_.heard_s = now_s;
  greet(now_s);
}

void Link::greet(double now_s) {
  wire::Frame frame;
  frame.kind = wire::kind_hello;
  frame.length = wire::hello::length;
  frame.payload[wire::hello::version] = wire::protocol_version;
  port_->write({0});  // ends whatever the board has heard of a frame so far
  send(frame, now_s);
  times_.greeted_s = now_s;
}

void Link::send(const wire::Frame& frame, double now_s) {
  wire::Frame stamped = frame;
  stamped.session = session_;
  std::vector<std::uint8_t> bytes(wire::max_encoded);
  bytes.resize(wire::encode(stamped, bytes.data()));
  port_->write(bytes);
  times_.sent_s = now_s;
  ++counts_.sent;
}

void Link::receive(double now_s) {
  for (const std::uint8_t byte : port_->read()) {
    if (decoder_.feed(byte)) handle(decoder_.frame(), now_s);
    if (!port_) return;
  }
  counts_.damaged += static_cast<std::uint16_t>(decoder_.damaged() - damaged_before_);
  damaged_before_ = decoder_.damaged();
}

void Link::handle(const wire::Frame& frame, double now_s) {
  ++counts_.received;
  const bool ours = frame.session == session_;
  if (frame.kind == wire::kind_acknowledge && state_ == State::open) {
    if (frame.payload[wire::acknowledge::result] == wire::result_wrong_session) {
      lose("the board was reset, or has another host", now_s);
      return;
    }
    if (ours) handle_acknowledgement(frame, now_s);
  }
  if (!ours && frame.kind != wire::kind_welcome) return;
  times_.heard_s = now_s;
  if (frame.kind == wire::kind_welcome && state_ == State::greeting) handle_welcome(frame);
  if (frame.kind == wire::kind_state && state_ == State::open) {
    events_.push_back(DriveReport{
        frame.payload[wire::state::drive], wire::get_i24(frame.payload + wire::state::position),
        wire::get_i24(frame.payload + wire::state::target), wire::get_u16(frame.payload + wire::state::flags)});
  }
}

void Link::handle_welcome(const wire::Frame& frame) {
  const int version = frame.payload[wire::welcome::version];
  if (version != wire::protocol_version) {
    throw PortError("the board speaks protocol " + std::to_string(version) + ", this driver " +
                    std::to_string(wire::protocol_version) + ": flash its firmware again");
  }
  const std::uint8_t firmware = frame.payload[wire::welcome::firmware];
  if (firmware != options_.firmware) {
    throw PortError("the board runs the firmware for " + words_of_firmware(firmware) + ", the rig's file lists " +
                    words_of_firmware(options_.firmware) +
                    ": take the right file or board, or flash the other firmware");
  }
  if (frame.session != session_) return;
  const bool same = wire::get_u16(frame.payload + wire::welcome::configuration_crc) == configuration_crc_;
  state_ = State::open;
  last_number_ = frame.number;
  times_.backoff_s = options_.first_backoff_s;
  last_failure_.clear();
  ++counts_.opened;
  events_.push_back(LinkOpened{same, frame.payload[wire::welcome::drive_count]});
  settle_request(same, frame.number);
}

// What became of the request that was under way when the link was lost. Where the board has executed it, asking once
// more brings its answer; where not, it is too late for it. A board that was reset knows nothing of it.
void Link::settle_request(bool same_board, std::uint8_t last_number) {
  if (!request_) return;
  if (same_board && request_->frame.number == last_number) {
    request_->sent_s = times_.now_s - options_.resend_s;
    return;
  }
  events_.push_back(RequestLost{request_->frame.kind});
  request_.reset();
}

void Link::handle_acknowledgement(const wire::Frame& frame, double now_s) {
  if (!request_ || frame.number != request_->frame.number) return;
  const std::uint8_t result = frame.payload[wire::acknowledge::result];
  if (result == wire::result_out_of_order || result >= wire::result_count) {
    lose("the board has lost count of the requests", now_s);
    return;
  }
  last_number_ = frame.number;
  events_.push_back(RequestAnswered{request_->frame.kind, static_cast<wire::Result>(result)});
  request_.reset();
}

void Link::keep_up(double now_s) {
  if (state_ == State::greeting) {
    if (now_s - times_.heard_s > options_.greeting_s) throw PortError("no answer from the board");
    if (now_s - times_.greeted_s >= greeting_period_s) greet(now_s);
    return;
  }
  if (state_ != State::open) return;
  if (now_s - times_.heard_s > options_.lost_s) throw PortError("the board went silent");
  if (request_ && now_s - request_->sent_s >= options_.resend_s) {
    request_->sent_s = now_s;
    ++counts_.resent;
    send(request_->frame, now_s);
  }
  if (now_s - times_.sent_s >= options_.alive_s) {
    wire::Frame alive;
    alive.kind = wire::kind_alive;
    send(alive, now_s);
  }
}

void Link::request(wire::Kind kind, const std::vector<std::uint8_t>& payload, double now_s) {
  assert(open() && !busy() && payload.size() <= wire::max_payload);
  Request request{{}, now_s};
  request.frame.kind = kind;
  request.frame.number = static_cast<std::uint8_t>(last_number_ + 1);
  request.frame.length = static_cast<std::uint8_t>(payload.size());
  std::copy(payload.begin(), payload.end(), request.frame.payload);
  request_ = request;
  try {
    send(request_->frame, now_s);
  } catch (const PortError& error) {
    lose(error.what(), now_s);
  }
}

void Link::emergency_stop() {
  if (!port_) return;
  wire::Frame frame;
  frame.kind = wire::kind_emergency_stop;
  frame.number = last_number_;  // its answer must not pass for that of the request under way
  try {
    send(frame, times_.now_s);
  } catch (const PortError& error) {
    lose(error.what(), times_.now_s);
  }
}

void Link::lose(const std::string& reason, double now_s) {
  port_.reset();
  times_.attempt_s = now_s + times_.backoff_s;
  times_.backoff_s = std::min(2.0 * times_.backoff_s, options_.last_backoff_s);
  const bool was_open = state_ == State::open;
  state_ = State::closed;
  if (was_open) ++counts_.lost;
  if (was_open || reason != last_failure_) events_.push_back(LinkLost{reason});
  last_failure_ = reason;
}

}  // namespace soft_robot_lab
