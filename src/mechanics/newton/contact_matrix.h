// SPDX-License-Identifier: BSD-3-Clause
// Newton's matrix where skin touches skin: the body's own, with the couplings of the faces that touch. Its pattern
// lasts while they are in it, and keeps the order of elimination unless that has become much dearer than a new one.
#pragma once

#include <memory>
#include <vector>

#include "mechanics/contact/skin_pairs.h"
#include "mechanics/elements/clique_adder.h"
#include "mechanics/linear_algebra/block_cholesky.h"
#include "mechanics/linear_algebra/block_matrix.h"

namespace soft_robot_lab {

// What does not change with the values; states that are saved share it.
class ContactPattern {
 public:
  // `pairs`: sorted; `cliques`: the nodes of each. `body`: what they are added to, with its factor's.
  ContactPattern(const BlockPattern& body, const FactorPattern& body_factor, std::vector<FacePair> pairs,
                 const std::vector<std::vector<int>>& cliques);

  int index_of(const FacePair& pair) const;  // -1: not in it
  const std::shared_ptr<const BlockPattern>& matrix() const { return matrix_; }
  const std::shared_ptr<const FactorPattern>& factor() const { return factor_; }
  const CliquePlaces& places() const { return *places_; }
  void copy(const BlockMatrix& body, BlockMatrix& matrix) const;

 private:
  std::vector<FacePair> pairs_;
  std::shared_ptr<const BlockPattern> matrix_;
  std::shared_ptr<const FactorPattern> factor_;
  std::unique_ptr<const CliquePlaces> places_;
  struct Place {
    int slot;
    bool transposed;
  };
  std::vector<Place> of_body_;  // per block of the body's matrix
};

// Goes on with other patterns in the same memory.
class ContactMatrix {
 public:
  explicit ContactMatrix(std::shared_ptr<const ContactPattern> pattern)
      : matrix(pattern->matrix()), factor(pattern->factor()), pattern_(std::move(pattern)) {}

  const std::shared_ptr<const ContactPattern>& pattern() const { return pattern_; }
  void follow(const std::shared_ptr<const ContactPattern>& pattern);

  BlockMatrix matrix;
  BlockCholesky factor;

 private:
  std::shared_ptr<const ContactPattern> pattern_;
};

}  // namespace soft_robot_lab
