// SPDX-License-Identifier: BSD-3-Clause
#include "design_search.h"

#include <algorithm>

#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/cmaes.hpp>
#include <pagmo/algorithms/de.hpp>
#include <pagmo/algorithms/nsga2.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <pagmo/types.hpp>

#include "study/sweeps/sampling.h"

namespace soft_robot_lab {
namespace {

constexpr int kMostIdle = 5;        // generations in a row without a new design
constexpr double kUnknown = 3.0e6;  // worse than any design

// What a generation asks for does not hang on its own answers. So it is run once on answers that do not matter, to hear
// all that it asks for, and again with those that were found for all at a time.
struct Questions {
  DesignEvaluator* evaluator = nullptr;
  std::size_t objectives = 1, parameters = 1;
  std::vector<DesignPoint> asked;
};

// pagmo copies it freely; the questions stay where they are.
struct DesignProblem {
  Questions* questions = nullptr;

  pagmo::vector_double fitness(const pagmo::vector_double& point) const {
    if (questions->evaluator->knows(point)) return questions->evaluator->at(point).fitness;
    questions->asked.push_back(point);
    return pagmo::vector_double(questions->objectives, kUnknown);
  }
  pagmo::vector_double::size_type get_nobj() const { return questions ? questions->objectives : 1; }
  std::pair<pagmo::vector_double, pagmo::vector_double> get_bounds() const {
    const std::size_t count = questions ? questions->parameters : 1;  // pagmo also makes one that is never asked
    return {pagmo::vector_double(count, 0.0), pagmo::vector_double(count, 1.0)};
  }
  pagmo::thread_safety get_thread_safety() const { return pagmo::thread_safety::none; }
};

pagmo::algorithm make_method(const std::string& method, unsigned int seed) {
  constexpr double own = -1.0, first_step = 0.25, precision = 1.0e-12;
  if (method == "nsga2") return pagmo::algorithm(pagmo::nsga2(1u, 0.95, 10.0, 0.2, 50.0, seed));
  if (method == "differential_evolution")
    return pagmo::algorithm(pagmo::de(1u, 0.8, 0.9, 2u, precision, precision, seed));
  return pagmo::algorithm(pagmo::cmaes(1u, own, own, own, own, first_step, precision, precision, true, true, seed));
}

// A Latin hypercube.
std::vector<DesignPoint> first_points(const SearchSettings& search) {
  StudySettings study = study_of(search, "assess");
  for (StudyParameter& parameter : study.parameters) {
    parameter.min = 0.0;
    parameter.max = 1.0;
    parameter.logarithmic = false;
  }
  return sample(study);
}

bool better(const std::vector<double>& one, const std::vector<double>& other) {
  bool strictly = false;
  for (std::size_t i = 0; i < one.size(); ++i) {
    if (one[i] > other[i]) return false;
    strictly = strictly || one[i] < other[i];
  }
  return strictly;
}

}  // namespace

bool search_designs(const SearchSettings& search, DesignEvaluator& evaluator) {
  Questions questions{&evaluator, search.objectives.size(), search.parameters.size(), first_points(search)};
  if (!evaluator.evaluate(questions.asked)) return false;
  pagmo::population members(pagmo::problem(DesignProblem{&questions}), 0u, static_cast<unsigned int>(search.seed));
  for (const DesignPoint& point : questions.asked) members.push_back(point, evaluator.at(point).fitness);
  const pagmo::algorithm method = make_method(search.method, static_cast<unsigned int>(search.seed));
  const auto most = static_cast<std::size_t>(search.designs);
  for (int idle = 0; idle < kMostIdle && evaluator.designs().size() < most;) {
    questions.asked.clear();
    pagmo::algorithm(method).evolve(members);
    const std::size_t before = evaluator.designs().size();
    if (questions.asked.size() > most - before) questions.asked.resize(most - before);
    if (!evaluator.evaluate(questions.asked)) return false;
    members = method.evolve(members);
    idle = evaluator.designs().size() == before ? idle + 1 : 0;
  }
  return true;
}

std::vector<std::size_t> pareto_front(const std::vector<Design>& designs) {
  std::vector<std::size_t> front;
  for (std::size_t i = 0; i < designs.size(); ++i) {
    if (!designs[i].good) continue;
    bool dominated = false;
    for (std::size_t j = 0; j < designs.size() && !dominated; ++j) {
      const bool twin = j < i && designs[j].fitness == designs[i].fitness;
      dominated = designs[j].good && (twin || better(designs[j].fitness, designs[i].fitness));
    }
    if (!dominated) front.push_back(i);
  }
  std::sort(front.begin(), front.end(),
            [&](std::size_t a, std::size_t b) { return designs[a].fitness < designs[b].fitness; });
  return front;
}

}  // namespace soft_robot_lab
