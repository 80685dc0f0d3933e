// SPDX-License-Identifier: BSD-3-Clause
// propose_poses ROBOT.yaml --parameters A,B: which poses to drive for a fit, and how sure it will be.
#include <cstdio>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "robot/scene/parameters.h"
#include "settings/command_line.h"
#include "settings/words.h"
#include "soft_robot_lab/control/identification/propose_poses.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"

namespace {

using namespace soft_robot_lab;

struct Arguments {
  std::string robot, output, criterion = "determinant";
  std::vector<std::string> set;
  ProposalRequest request;
};

void declare(CommandLine& app, Arguments& arguments) {
  ProposalRequest& request = arguments.request;
  app.add_option("ROBOT", arguments.robot, "a scene's or robot's file, as it is expected to be")
      .type_name("FILE")
      .required();
  app.add_option_function<std::vector<std::string>>(
         "--parameters",
         [&request](const std::vector<std::string>& names) {
           for (const std::string& name : names) request.parameters.push_back({name, {}, {}, {}});
         },
         "what will be fitted, with commas between, as fit_model has them; not damping and creep")
      .delimiter(',')
      .one_value_at_a_time()
      .required()
      .type_name("A,B,...");
  app.add_option("--poses", request.poses, "how many to drive").type_name("N").show_default();
  app.add_option("--candidates", request.candidates, "of which each next pose is the best")
      .type_name("N")
      .show_default();
  app.add_option("--deviation", request.deviation_m, "standard deviation of a marker's coordinate at a pose")
      .type_name("METRES")
      .show_default();
  app.add_option("--criterion", arguments.criterion,
                 "what is to be small: determinant (D) or trace (A) of the covariance")
      .type_name("NAME")
      .one_of({"determinant", "trace"})
      .show_default();
  app.add_option("--seed", request.seed, "of the candidates").type_name("N").show_default();
  app.add_option("--mass", request.mass_kg, "of the whole robot, weighed").type_name("KG");
  app.add_set_option(arguments.set);
  app.add_option("--output", arguments.output, "where the table of commands goes, for run_table_node")
      .type_name("FILE");
  app.footer("Exit status: 0 proposed, 1 no pose rests, 2 bad robot or arguments.");
}

std::string table_yaml(const PoseProposal& proposal, const std::string& robot) {
  std::ostringstream yaml;
  yaml << "# Proposed for a fit of " << robot << "; commands of " << join(proposal.actuators) << ".\nconfigurations:\n";
  for (std::size_t i = 0; i < proposal.commands.size(); ++i) {
    std::vector<std::string> values;
    for (const double value : proposal.commands[i]) values.push_back(format_number(value));
    yaml << "  - {name: p" << i + 1 << ", commands: [" << join(values) << "]}\n";
  }
  return yaml.str();
}

int propose(Arguments arguments) {
  arguments.request.criterion = arguments.criterion == "trace" ? DesignCriterion::trace : DesignCriterion::determinant;
  SceneOptions options;
  options.actuator_factory = make_actuator;
  options.overrides = parameter_overrides(arguments.robot, arguments.set);
  const PoseProposal proposal = propose_poses(arguments.robot, options, arguments.request);
  const std::string table = table_yaml(proposal, arguments.robot);
  if (arguments.output.empty())
    std::cout << table;
  else
    write_file(arguments.output, table);
  for (const FittedValue& value : proposal.values)
    std::printf("%s = %g: expected +- %.2g%s\n", value.name.c_str(), value.value, value.deviation,
                value.identifiable ? "" : ", not identifiable");
  return kGood;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app(
      "Proposes poses to drive so that fit_model finds its parameters best, and states how sure it will be, by the\n"
      "sensitivities of the model.",
      "propose_poses");
  Arguments arguments;
  declare(app, arguments);
  return run_program(app, argc, argv, [&] { return propose(arguments); });
}
