// What the chart of stability shows: bodies, methods, hard cases.
#include "experiment/stability_starts.h"
#include "soft_robot_lab/experiment/stability.h"

namespace soft_robot_lab {

std::vector<StabilityBody> stability_bodies() {
  return {{"cantilever", "scenes/cantilever_cables.yaml"},
          {"Hammerbot", "robots/hammerbot.yaml"},
          {"Spinebot", "robots/spinebot.yaml"}};
}

std::vector<StabilityMethod> stability_methods() {
  const std::string linear = "body: {element: linear}\n", bdf2 = "solver: {integrator: bdf2}\n",
                    substeps = "solver: {method: gauss_seidel, substeps: 50}\n";
  return {{"global, equilibrium", "", true, true},
          {"global, dynamic", "", false, true},
          {"global, dynamic, bdf2", bdf2, false, true},
          {"global, equilibrium, linear", linear, true},
          {"global, dynamic, linear", linear},
          {"gauss_seidel", substeps},
          {"gauss_seidel, linear", linear + substeps}};
}

namespace {

HardCase with_poissons_ratio(const std::string& ratio) {
  return {"Poisson's ratio " + ratio, "body: {material: {poissons_ratio: " + ratio + "}}", "", {0.9}};
}

HardCase with_time_step(const std::string& step) {
  return {"time step " + step + " s", "solver: {time_step_s: " + step + "}", "", {0.9}};
}

HardCase with_compliance(const std::string& compliance) {
  return {"cable compliance " + compliance + " m/N", "", "compliance_m_n: " + compliance, {0.9}};
}

HardCase pulled_at_once(const std::string& name, const std::vector<double>& pulls, const std::string& compliance) {
  HardCase pulled{name, "", "{pull_speed_m_s: 0, min_contraction: 0.5, compliance_m_n: " + compliance + "}", pulls};
  pulled.unique = false;
  return pulled;
}

HardCase with_slivers(const std::string& height) {
  HardCase slivers{"slivers of height " + height, "", "", {0.9}};
  const double share = std::stod(height);
  slivers.change_mesh = [share](TetMesh& mesh) { add_slivers(mesh, share, 10); };
  return slivers;
}

HardCase from(const std::string& name, const std::function<void(const Body&, Eigen::Matrix3Xd&)>& start, double pull,
              bool unique) {
  HardCase bad{name, "", "pull_speed_m_s: 0", {pull}};
  bad.start_from = start;
  bad.unique = unique;
  return bad;
}

}  // namespace

std::vector<HardCase> hard_cases() {
  std::vector<HardCase> cases;
  for (const char* ratio : {"0.45", "0.499", "0.4999", "0.499999"}) cases.push_back(with_poissons_ratio(ratio));
  for (const char* step : {"0.001", "0.01", "0.1", "1"}) cases.push_back(with_time_step(step));
  for (const char* compliance : {"1.0e-2", "1.0e-4", "0"}) cases.push_back(with_compliance(compliance));
  cases.push_back(pulled_at_once("contraction 1 to 0.5 at once", {0.5}, "1.0e-5"));
  cases.push_back(pulled_at_once("the same, rigid cable", {0.5}, "0"));
  cases.push_back(pulled_at_once("the same, both cables", {0.5, 0.5}, "1.0e-5"));
  for (const char* height : {"1.0e-2", "1.0e-4"}) cases.push_back(with_slivers(height));
  cases.push_back(from("scrambled nodes", scramble, 1.0, true));
  cases.push_back(from("scrambled nodes, pulled", scramble, 0.9, true));
  cases.push_back(from("collapsed to a plane", collapse_to_plane, 1.0, true));
  cases.push_back(from("collapsed to a line", collapse_to_line, 1.0, true));
  cases.push_back(from("collapsed to a point", collapse_to_point, 1.0, true));
  cases.push_back(from("collapsed to a point, pulled", collapse_to_point, 0.9, true));
  cases.push_back(from("turned inside out", mirror, 1.0, true));
  return cases;
}

}  // namespace soft_robot_lab
