// SPDX-License-Identifier: BSD-3-Clause
// What session_rviz loads into rviz first. Ogre (1.12) makes its window over one connection to the X server, sends that
// off by XFlush, and draws on the window over another connection. A busy server may answer that one first: it knows no
// such window yet, and Mesa, which does not look whether it got the window's size, draws beyond its memory. So XFlush
// waits for the server here.
#include <cstdlib>

#include <dlfcn.h>

namespace {

__attribute__((constructor)) void stay_out_of_what_rviz_starts() { unsetenv("LD_PRELOAD"); }

}  // namespace

extern "C" int XFlush(void* display) {
  static const auto sync = reinterpret_cast<int (*)(void*, int)>(dlsym(RTLD_NEXT, "XSync"));
  return sync == nullptr ? 0 : sync(display, 0);
}
