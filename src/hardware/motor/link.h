// SPDX-License-Identifier: BSD-3-Clause
// A session with the board: opens the port and opens it again when it is lost, greets, sends one numbered request at a
// time until it is answered, and hands on what the board reports. Never waits; time is an argument.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "framing.h"
#include "port.h"

namespace soft_robot_lab {

struct LinkOptions {
  wire::Firmware firmware = wire::firmware_motors;  // that the board has to run
  double resend_s = 0.02;                           // a request that was not answered is sent again
  double alive_s = 0.04;          // something is sent at least so often: a noisy line loses some of it
  double lost_s = 0.3;            // without a sound frame the link counts as lost
  double greeting_s = 3.0;        // a board that was reset by opening the port boots first
  double first_backoff_s = 0.05;  // between attempts to open, doubled each time
  double last_backoff_s = 2.0;
  std::uint8_t first_session = 1;  // any but the last run's
};

struct LinkOpened {
  bool same_configuration;  // the board still has ours; else it has been reset, or had another host
  int drive_count;
};
struct LinkLost {
  std::string reason;
};
struct RequestAnswered {
  std::uint8_t kind;
  wire::Result result;
};
// The link was lost before the board had executed it.
struct RequestLost {
  std::uint8_t kind;
};
struct DriveReport {
  int drive;
  std::int32_t position;  // microsteps, or Pa
  std::int32_t target;    // likewise
  std::uint16_t flags;
};
using LinkEvent = std::variant<LinkOpened, LinkLost, RequestAnswered, RequestLost, DriveReport>;

struct LinkCounts {
  std::int64_t sent = 0, resent = 0, received = 0, damaged = 0, opened = 0, lost = 0;
};

class Link {
 public:
  Link(LinkOptions options, std::uint16_t configuration_crc, OpenPort open_port);

  std::vector<LinkEvent> update(double now_s);
  bool open() const { return state_ == State::open; }
  bool busy() const { return request_.has_value(); }
  void request(wire::Kind kind, const std::vector<std::uint8_t>& payload, double now_s);  // needs open() and not busy()
  void emergency_stop();  // sent at once where there is a port; ask again until the drives report it
  const LinkCounts& counts() const { return counts_; }

 private:
  enum class State { closed, greeting, open };
  struct Request {
    wire::Frame frame;
    double sent_s;
  };

  // When these were last done, or are due.
  struct Times {
    double now_s = 0.0;
    double heard_s = 0.0, sent_s = 0.0, greeted_s = 0.0;
    double attempt_s = 0.0;  // the next one to open
    double backoff_s = 0.0;  // after it
  };

  void try_to_open(double now_s);
  void receive(double now_s);
  void handle(const wire::Frame& frame, double now_s);
  void handle_welcome(const wire::Frame& frame);
  void handle_acknowledgement(const wire::Frame& frame, double now_s);
  void settle_request(bool same_board, std::uint8_t last_number);
  void keep_up(double now_s);
  void lose(const std::string& reason, double now_s);
  void send(const wire::Frame& frame, double now_s);
  void greet(double now_s);

  LinkOptions options_;
  std::uint16_t configuration_crc_;
  OpenPort open_port_;
  State state_ = State::closed;
  std::unique_ptr<Port> port_;
  wire::FrameDecoder decoder_;
  std::uint16_t damaged_before_ = 0;
  std::optional<Request> request_;
  std::uint8_t session_;
  std::uint8_t last_number_ = 0;
  Times times_;
  std::string last_failure_;
  std::vector<LinkEvent> events_;
  LinkCounts counts_;
};

}  // namespace soft_robot_lab
