#include "mechanics/xpbd/xpbd_solver.h"
