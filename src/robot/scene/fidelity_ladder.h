// SPDX-License-Identifier: BSD-3-Clause
// The meshes that a choice looks at.
#pragma once

#include <deque>
#include <exception>
#include <optional>

#include "fidelity.h"

namespace soft_robot_lab {

struct Rung {
  FidelityChoice choice;
  std::optional<YamlNode> scene;  // with the choice
  TetMesh mesh;
  MeshError error;
  JudgedRests rests;
};

// Walks from coarse to fine by sizes that hang on the scene alone, so that a looser tolerance never asks for a finer
// mesh at rest. A rung on which the scene cannot be built (a load's box without a whole face) is passed over; where
// none can be built, the last complaint is thrown.
class FidelityLadder {
 public:
  FidelityLadder(const FidelityRequest& request, Judgement& judgement);

  // The next finer rung, judged; none beyond the limit on nodes. `enough_m` as MeshJudge has it.
  std::optional<Rung> next(double enough_m);
  // The finer rung by which the first ones are judged; none where the first is fine enough.
  const std::optional<Rung>& judging() const { return judging_; }
  int judging_nodes() const { return judging_ ? judging_->mesh.node_count() : 0; }
  int count() const { return count_; }  // of rungs that were judged
  const std::optional<NearBuckling>& near_buckling() const { return judge_.near_buckling(); }

 private:
  std::optional<Rung> meshed();
  const Rung* rung_of(int nodes);
  bool judge_by(const Rung& rung);
  void begin();
  bool judged(double enough_m, Rung& rung);
  std::optional<Rung> beyond_limit(Rung rung) const;
  std::optional<Rung> at_buckling();

  const FidelityRequest& request_;
  Judgement& judgement_;
  MeshJudge judge_;
  const bool given_;  // the mesh: it is the only rung
  double size_m_ = 0.0;
  int last_nodes_ = 0, count_ = 0, shown_nodes_ = 0;
  bool begun_ = false, done_ = false;
  std::deque<Rung> waiting_;  // meshed, not judged
  std::optional<Rung> judging_;
  std::exception_ptr complaint_;
};

// The scene with elements as large as its solid allows: of all meshes of a solid, the first to be made.
YamlNode outline_of(const YamlNode& settings);

void show_judging(const TetMesh& mesh, double fraction, const SceneOptions& options);

}  // namespace soft_robot_lab
