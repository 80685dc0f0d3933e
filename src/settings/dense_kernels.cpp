// SPDX-License-Identifier: BSD-3-Clause
#define SOFT_ROBOT_LAB_DENSE template
#include "dense_kernels.h"
