#include <cstdio>
#include <cstring>
#include "soft_robot_lab/actuators/factory.h"
#include "soft_robot_lab/experiment/stability.h"
using namespace soft_robot_lab;
int main(int argc, char** argv) {
  // args: body-substr method-substr case-substr
  auto has = [&](int i, const std::string& s) { return argc <= i || s.find(argv[i]) != std::string::npos; };
  auto exact = [&](int i, const std::string& s) { if (argc > i && argv[i][0] == '=') return s == argv[i] + 1; return has(i, s); };
  SceneOptions options; options.actuator_factory = make_actuator; options.mesher = MESHER;
  StabilityBench bench(options, CONFIG);
  for (auto& b : stability_bodies()) if (exact(1, b.name))
    for (auto& c : hard_cases()) if (exact(3, c.name))
      for (auto& m : stability_methods()) if (exact(2, m.name)) {
        try {
          auto r = bench.run(b, m, c);
          std::printf("%-11s|%-30s|%-28s|%-18s| %d/%d off %.3f mm cpu %.2f %s\n", b.name.c_str(), c.name.c_str(), m.name.c_str(), name_of(r.outcome), r.failed_solves, r.solves, 1e3*r.off_m, r.cpu_s, r.message.c_str());
        } catch (std::exception& e) { std::printf("%s|%s|%s ERROR %s\n", b.name.c_str(), c.name.c_str(), m.name.c_str(), e.what()); }
        std::fflush(stdout);
      }
}
