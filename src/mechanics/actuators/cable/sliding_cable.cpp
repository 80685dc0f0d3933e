// SPDX-License-Identifier: BSD-3-Clause
#include "cable_model.h"
#include "path_length.h"

namespace soft_robot_lab {
namespace {

class SlidingCable : public CableModel {
 public:
  SlidingCable(const std::vector<EmbeddedPoint>& points, const Eigen::Matrix3Xd& rest_positions_m,
               CommandReader command, double compliance_m_n, std::vector<SpanString> strings)
      : command_(std::move(command)),
        compliance_m_n_(compliance_m_n),
        path_(
            points, rest_positions_m, [this](const DriveState& drive) { return law(drive); }, std::move(strings)) {}

  std::vector<const Constraint*> constraints() const override { return {&path_}; }
  std::optional<LawChange> law_change(const std::string& key, const Eigen::Matrix3Xd& /*positions_m*/,
                                      const std::vector<double>& multipliers,
                                      const DriveState& /*drive*/) const override {
    if (key != "compliance_m_n") return std::nullopt;
    return LawChange{Eigen::VectorXd::Constant(1, -multipliers[0]), {}};
  }
  std::vector<double> tensions_n(const std::vector<double>& multipliers, const DriveState& /*drive*/) const override {
    return multipliers;
  }
  double compliance_m_n() const override { return compliance_m_n_; }
  const Path& path() const override { return path_.path(); }

 private:
  CableLaw law(const DriveState& drive) const {
    const DriveCommand command = command_(drive.actuated_command);
    return command.by_tension ? CableLaw::of_tension(command.tension_n, command.per_command)
                              : CableLaw::of_length(command.length_m, compliance_m_n_, command.per_command);
  }

  CommandReader command_;
  double compliance_m_n_;
  PathLength path_;
};

}  // namespace

std::unique_ptr<CableModel> make_sliding_cable(const std::vector<EmbeddedPoint>& points,
                                               const Eigen::Matrix3Xd& rest_positions_m, CommandReader command,
                                               double compliance_m_n, std::vector<SpanString> strings) {
  return std::make_unique<SlidingCable>(points, rest_positions_m, std::move(command), compliance_m_n,
                                        std::move(strings));
}

}  // namespace soft_robot_lab
