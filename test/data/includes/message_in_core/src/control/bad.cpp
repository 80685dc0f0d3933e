#include <soft_robot_lab/Policy.h>
