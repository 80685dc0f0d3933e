#include "soft_robot_lab/sim/body.h"
