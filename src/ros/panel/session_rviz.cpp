// SPDX-License-Identifier: BSD-3-Clause
// session_rviz auto|true|false ARGUMENTS...: rviz, with smooth edges or without. `auto`: without where software draws,
// as smoothing them takes most of its time there, and the window answers late.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <QGuiApplication>
#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QOpenGLFunctions>
#include <unistd.h>

namespace {

// Mesa's names for it.
bool software_draws(int argc, char** argv) {
  const QGuiApplication application(argc, argv);
  QOffscreenSurface surface;
  surface.create();
  QOpenGLContext context;
  if (!context.create() || !context.makeCurrent(&surface)) return false;
  const std::string drawer = reinterpret_cast<const char*>(context.functions()->glGetString(GL_RENDERER));
  for (const char* name : {"llvmpipe", "softpipe", "swrast"})
    if (drawer.find(name) != std::string::npos) return true;
  return false;
}

// Files have decimal points: what LC_ALL says of all else, LANG says then.
void keep_decimal_points() {
  if (const char* all = std::getenv("LC_ALL"); all && *all) setenv("LANG", all, 1);
  unsetenv("LC_ALL");
  setenv("LC_NUMERIC", "C", 1);
}

// By its name, as a path with a blank in it would be two.
void load_into_rviz(const std::string& library) {
  const std::string folder = (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "..").string();
  const auto put_first = [](const char* variable, const std::string& value) {
    const char* before = std::getenv(variable);
    setenv(variable, (before && *before ? value + ":" + before : value).c_str(), 1);
  };
  put_first("LD_LIBRARY_PATH", folder);
  put_first("LD_PRELOAD", library);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string smooth = argc > 1 ? argv[1] : "";
  if (smooth != "auto" && smooth != "true" && smooth != "false") {
    std::fprintf(stderr, "session_rviz: smooth_edges: '%s', must be auto, true or false\n", smooth.c_str());
    return 2;
  }
  std::vector<char*> arguments = {const_cast<char*>("rviz")};
  if (smooth == "false" || (smooth == "auto" && software_draws(argc, argv)))
    arguments.push_back(const_cast<char*>("--disable-anti-aliasing"));
  arguments.insert(arguments.end(), argv + 2, argv + argc + 1);  // with the null at their end
  keep_decimal_points();
  load_into_rviz("libsrl_window_order.so");
  execvp("rviz", arguments.data());
  std::perror("session_rviz: rviz");
  return 127;
}
