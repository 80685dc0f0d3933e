#include "sim/newton_solver.h"
