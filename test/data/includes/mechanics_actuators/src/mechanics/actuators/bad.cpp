#include "mechanics/newton/newton_solver.h"
