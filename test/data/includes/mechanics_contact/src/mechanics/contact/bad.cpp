#include "soft_robot_lab/mechanics/simulation.h"
