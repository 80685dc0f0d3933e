#include "soft_robot_lab/mechanics/obstacle.h"
