#include "solve_ending.h"

#include <sstream>
#include <string>

namespace soft_robot_lab {
namespace {

// "element 12 at rest position (0.01, 0, 0.02) m"
std::string place_of(int element, const Body& body) {
  if (element < 0) return "nowhere";
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (int corner = 0; corner < 4; ++corner)
    centre += 0.25 * body.mesh().nodes_m.col(body.mesh().tets(corner, element));
  std::ostringstream text;
  text << "element " << element << " at rest position (" << centre.x() << ", " << centre.y() << ", " << centre.z()
       << ") m";
  return text.str();
}

}  // namespace

void tell_end(const NewtonReport& newton, const Body& body, SolveReport& report) {
  report.converged = newton.converged;
  report.residual = newton.residual;
  report.inverted_elements = newton.inverted_elements;
  report.message = newton.reason;
  if (newton.inverted_elements > 0) {
    if (!report.message.empty()) report.message += "; ";
    report.message += std::to_string(newton.inverted_elements) + " inverted elements, the worst " +
                      place_of(newton.worst_element, body);
  }
}

}  // namespace soft_robot_lab
