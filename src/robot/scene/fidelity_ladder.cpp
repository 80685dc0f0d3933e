// SPDX-License-Identifier: BSD-3-Clause
#include "fidelity_ladder.h"

#include <cmath>

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

constexpr double kOutlineSize_m = 10.0;  // larger than any robot: a mesh as coarse as the solid allows
constexpr double kCoarsest = 8.0;        // over the thickness of the body
constexpr double kSmaller = 0.8;         // of the size, from rung to rung
constexpr int kLeastReference = 300;     // nodes of the first mesh that is subdivided
constexpr int kFarFiner = 3;             // nodes over those of that mesh, of one that has to agree with it
constexpr double kWorthTrying = 1.25;    // more nodes than the rung before: small features may rule the mesh

// The number that three digits say: a quotient of whole numbers.
double three_digits(double value) {
  const double digits = 2.0 - std::floor(std::log10(value));
  return digits >= 0.0 ? std::round(value * std::pow(10.0, digits)) / std::pow(10.0, digits)
                       : std::round(value / std::pow(10.0, -digits)) * std::pow(10.0, -digits);
}

// 4 volume / surface is the side of a long bar.
double thickness_m(const TetMesh& outline) {
  double surface_m2 = 0.0;
  TetMesh whole = outline;
  complete_boundary(whole);
  const auto corner = [&](Eigen::Index face, int i) -> Eigen::Vector3d {
    return whole.nodes_m.col(whole.faces(i, face));
  };
  for (Eigen::Index f = 0; f < whole.faces.cols(); ++f)
    surface_m2 += 0.5 * (corner(f, 1) - corner(f, 0)).cross(corner(f, 2) - corner(f, 0)).norm();
  return 4.0 * volume(whole) / surface_m2;
}

}  // namespace

YamlNode outline_of(const YamlNode& settings) {
  FidelityChoice coarse;
  coarse.element_size_m = kOutlineSize_m;
  return overrides_of(coarse).over(settings);
}

void show_judging(const TetMesh& mesh, double fraction, const SceneOptions& options) {
  if (options.progress)
    options.progress(fraction, "fidelity: judges a mesh of " + std::to_string(mesh.node_count()) + " nodes");
}

FidelityLadder::FidelityLadder(const FidelityRequest& request, Judgement& judgement)
    : request_(request),
      judgement_(judgement),
      judge_(judgement),
      given_(judgement.settings.child("body").has("mesh")) {
  if (!given_)
    size_m_ = three_digits(kCoarsest * thickness_m(read_mesh(outline_of(judgement.settings), judgement.options)));
}

// The next rung that is finer enough, not judged.
std::optional<Rung> FidelityLadder::meshed() {
  while (!done_) {
    Rung rung;
    if (!given_) rung.choice.element_size_m = size_m_;
    rung.scene = overrides_of(rung.choice).over(judgement_.settings);
    rung.mesh = read_mesh(*rung.scene, judgement_.options);
    size_m_ = three_digits(kSmaller * size_m_);
    done_ = given_ || rung.mesh.node_count() > request_.max_nodes;
    if (rung.mesh.node_count() < kWorthTrying * last_nodes_) continue;
    last_nodes_ = rung.mesh.node_count();
    return rung;
  }
  return std::nullopt;
}

// Meshes rungs until one has so many nodes; null where none within the limit has.
const Rung* FidelityLadder::rung_of(int nodes) {
  while (waiting_.empty() || waiting_.back().mesh.node_count() < nodes) {
    std::optional<Rung> rung = meshed();
    if (!rung) return nullptr;
    waiting_.push_back(std::move(*rung));
  }
  return waiting_.back().mesh.node_count() <= request_.max_nodes ? &waiting_.back() : nullptr;
}

bool FidelityLadder::judge_by(const Rung& rung) {
  show_judging(rung.mesh, 0.0, judgement_.options);
  Rung judging = rung;
  judging.error = judge_.look_ahead(*judging.scene, judging.mesh);
  judging.rests = judge_.rests();
  if (!judging.error.expected_m) return false;
  judging_ = std::move(judging);
  return true;
}

// Finds the mesh that judges the first rungs.
void FidelityLadder::begin() {
  begun_ = true;
  if (given_) return;
  try {
    for (const Rung* rung = rung_of(kLeastReference); rung;) {
      const bool judges = judge_by(*rung);
      shown_nodes_ = rung->mesh.node_count();
      if (judge_.near_buckling() || (!judges && judge_.rests().unseen.empty())) break;
      rung = rung_of(kFarFiner * rung->mesh.node_count());
      if (!judges || !rung) continue;
      shown_nodes_ = rung->mesh.node_count();
      if (!judge_.contradicted(*rung->scene, rung->mesh)) break;
    }
  } catch (const std::invalid_argument&) {
    complaint_ = std::current_exception();
  }
}

// No mesh says to which side the body goes: that which shows it is as good as any.
std::optional<Rung> FidelityLadder::at_buckling() {
  std::optional<Rung> rung;
  for (Rung& looked_at : waiting_)
    if (looked_at.mesh.node_count() == shown_nodes_) rung = std::move(looked_at);
  if (!rung) return std::nullopt;
  waiting_.clear();
  done_ = true;
  ++count_;
  rung->rests = judge_.rests();
  rung->error.trouble = text_of(*judge_.near_buckling());
  read_for_others(*rung->scene);
  rung->scene->require_all_read();
  return rung;
}

std::optional<Rung> FidelityLadder::next(double enough_m) {
  if (!begun_) {
    begin();
    if (judge_.near_buckling()) return at_buckling();
  }
  while (true) {
    std::optional<Rung> rung;
    if (waiting_.empty()) {
      rung = meshed();
    } else {
      rung = std::move(waiting_.front());
      waiting_.pop_front();
    }
    if (!rung) break;
    const int nodes = rung->mesh.node_count();
    if (nodes > request_.max_nodes) return beyond_limit(std::move(*rung));
    show_judging(rung->mesh, static_cast<double>(nodes) / request_.max_nodes, judgement_.options);
    if (!judged(enough_m, *rung)) continue;
    read_for_others(*rung->scene);
    rung->scene->require_all_read();
    return rung;
  }
  if (count_ == 0 && complaint_) std::rethrow_exception(complaint_);
  return std::nullopt;
}

bool FidelityLadder::judged(double enough_m, Rung& rung) {
  try {
    rung.error = judge_.judge(*rung.scene, rung.mesh, enough_m);
    rung.rests = judge_.rests();
  } catch (const std::invalid_argument&) {
    complaint_ = std::current_exception();
    return false;
  }
  ++count_;
  return true;
}

// Not judged, but all there is where it is the first.
std::optional<Rung> FidelityLadder::beyond_limit(Rung rung) const {
  if (count_ > 0) return std::nullopt;
  if (complaint_) std::rethrow_exception(complaint_);
  rung.error.trouble =
      "the coarsest mesh has " + std::to_string(rung.mesh.node_count()) + " nodes, more than max_nodes";
  return rung;
}

}  // namespace soft_robot_lab
