#include "mechanics/complementarity/multiplier_problem.h"
