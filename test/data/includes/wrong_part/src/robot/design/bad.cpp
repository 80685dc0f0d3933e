#include "soft_robot_lab/mechanics/body.h"
