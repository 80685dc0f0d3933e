// SPDX-License-Identifier: BSD-3-Clause
#include "shape.h"
