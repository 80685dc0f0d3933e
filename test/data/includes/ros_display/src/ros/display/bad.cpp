#include "ros/nodes/read_parameter.h"
