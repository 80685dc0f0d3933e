#include "mechanics/elements/rivlin_kernels.h"
