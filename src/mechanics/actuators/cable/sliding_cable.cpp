// SPDX-License-Identifier: BSD-3-Clause
#include "cable_model.h"
#include "path_length.h"

namespace soft_robot_lab {
namespace {

class SlidingCable : public CableModel {
 public:
  SlidingCable(const std::vector<EmbeddedPoint>& points, const Eigen::Matrix3Xd& rest_positions_m,
               double compliance_m_n)
      : path_(points, rest_positions_m), compliance_m_n_(compliance_m_n) {}

  std::vector<const Constraint*> constraints() const override { return {&path_}; }
  void command_length(double length_m, double length_per_command) override {
    path_.command_length(length_m, compliance_m_n_, length_per_command);
  }
  void command_tension(double tension_n, double tension_per_command) override {
    path_.command_tension(tension_n, tension_per_command);
  }
  std::optional<LawChange> law_change(const std::string& key, const Eigen::Matrix3Xd& /*positions_m*/,
                                      const std::vector<double>& multipliers) const override {
    if (key != "compliance_m_n") return std::nullopt;
    return LawChange{Eigen::VectorXd::Constant(1, -multipliers[0]), {}};
  }
  std::vector<double> tensions_n(const std::vector<double>& multipliers) const override { return multipliers; }
  double compliance_m_n() const override { return compliance_m_n_; }

 private:
  PathLength path_;
  double compliance_m_n_;
};

}  // namespace

std::unique_ptr<CableModel> make_sliding_cable(const std::vector<EmbeddedPoint>& points,
                                               const Eigen::Matrix3Xd& rest_positions_m, double compliance_m_n) {
  return std::make_unique<SlidingCable>(points, rest_positions_m, compliance_m_n);
}

}  // namespace soft_robot_lab
